#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"

/// Which instruction set HWY_DYNAMIC_DISPATCH chooses.
namespace talus::simd {

/// Those that both this processor and this build have, best first.
[[nodiscard]] std::vector<std::string> instruction_sets();

/// Backends and calibration loops that are made from now on run on the set of this name. Before the first choice they
/// run on the best. Errors: none of instruction_sets().
[[nodiscard]] Status choose_instruction_set(const std::string& name);

/// Chooses the set that the environment variable TALUS_SIMD names, if it names one. For the beginning of a program.
[[nodiscard]] Status choose_instruction_set_of_environment();

}  // namespace talus::simd
