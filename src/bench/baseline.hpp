#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace talus::bench {

/// Relative rates (see Calibration) by measurement (row_name).
using Rates = std::map<std::string, double>;

/// Relative rates measured earlier, by instruction set; not comparable between instruction sets.
using Baseline = std::map<std::string, Rates>;

/// A JSON object of objects of numbers. Errors: no such file, not such an object, a rate that is not above zero.
[[nodiscard]] Result<Baseline> read_baseline(const std::filesystem::path& file);

/// Errors: the file cannot be written.
[[nodiscard]] Status write_baseline(const std::filesystem::path& file, const Baseline& baseline);

/// The names in `expected` whose measured rate is less than `share` of it, or missing.
[[nodiscard]] std::vector<std::string> slower(const Rates& expected, const Rates& measured, double share);

/// For each name the higher of two rates: noise makes a program slower, never faster.
[[nodiscard]] Rates better_of(const Rates& a, const Rates& b);

}  // namespace talus::bench
