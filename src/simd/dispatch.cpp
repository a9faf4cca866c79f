#include "simd/dispatch.hpp"

#include <cstdlib>
#include <hwy/highway.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace talus::simd {
namespace {

/// Queried once, before the first choice: afterwards Highway reports only the chosen one.
const std::vector<std::int64_t>& available_targets() {
    static const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    return targets;
}

}  // namespace

std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    for (const std::int64_t target : available_targets()) names.emplace_back(hwy::TargetName(target));
    return names;
}

Status choose_instruction_set(const std::string& name) {
    for (const std::int64_t target : available_targets()) {
        if (name != hwy::TargetName(target)) continue;
        hwy::SetSupportedTargetsForTest(target);
        return {};
    }
    return Error{fmt::format("the instruction set \"{}\" is refused; this processor and this build have {}", name,
                             fmt::join(instruction_sets(), ", "))};
}

Status choose_instruction_set_of_environment() {
    const char* name = std::getenv("TALUS_SIMD");
    if (name == nullptr || *name == 0) return {};
    const Status chosen = choose_instruction_set(name);
    return chosen ? Status() : Error{"TALUS_SIMD: " + chosen.error().message};
}

}  // namespace talus::simd
