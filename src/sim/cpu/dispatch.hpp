#pragma once

#include <cstdlib>
#include <hwy/highway.h>
#include <string_view>

namespace talus::cpu {

/// Calls f(), which dispatches by HWY_DYNAMIC_DISPATCH, with the instruction set that TALUS_SIMD names if this
/// processor has it, else with its best.
template <class F>
auto with_wanted_instructions(const F& f) {
    if (const char* wanted = std::getenv("TALUS_SIMD")) {
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            if (std::string_view(wanted) != hwy::TargetName(target)) continue;
            hwy::SetSupportedTargetsForTest(target);
            const auto result = f();
            hwy::SetSupportedTargetsForTest(0);
            return result;
        }
    }
    return f();
}

}  // namespace talus::cpu
