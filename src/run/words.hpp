#pragma once

#include <string>

/// Letters and numbers of the sentences that say how a run went.
namespace talus::run {

/// With a capital letter, as where a sentence begins.
[[nodiscard]] std::string capitalised(std::string text);
/// Without one, as after "in the worst,".
[[nodiscard]] std::string uncapitalised(std::string text);

/// About `digits` significant digits, without an exponent and trailing zeros: at most four decimals. Not finite:
/// "unknown".
[[nodiscard]] std::string rounded(double value, int digits);

}  // namespace talus::run
