#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"

/// Which instruction set HWY_DYNAMIC_DISPATCH chooses.
namespace talus::simd {

/// Those that both this processor and this build have, best first.
[[nodiscard]] std::vector<std::string> instruction_sets();

/// Backends and calibration loops created from now on use the set of this name. Before the first choice they use the
/// best. Errors: none of instruction_sets().
[[nodiscard]] Status choose_instruction_set(const std::string& name);

/// Chooses the set that the environment variable TALUS_SIMD names, if it names one. To be called at program start.
[[nodiscard]] Status choose_instruction_set_of_environment();

}  // namespace talus::simd
