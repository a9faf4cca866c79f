#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

/// Distribution of a factor of an ensemble.
namespace talus::stats {

enum class DistributionKind { uniform, log_uniform, normal, triangular, list };

/// One factor's values, in the unit of its key. A number has a quantile for every share of the probability below it; a
/// list has entries, which may be texts, equally likely or by weight.
struct Distribution {
    DistributionKind kind = DistributionKind::uniform;
    /// Limits of the values. A normal distribution without limits is truncated at its key's allowed range.
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    double middle = 0;                 ///< mean of normal, mode of triangular
    double deviation = 0;              ///< standard deviation of normal
    std::vector<std::string> entries;  ///< of a list, as --set would take them
    std::vector<double> weights{};     ///< of the entries, in any unit; none: equal

    /// The value below which `share` (0 to 1) of the probability lies. Not for lists.
    [[nodiscard]] double quantile(double share) const;
    /// The entry of a list at `share` of its probability.
    [[nodiscard]] const std::string& entry(double share) const;
    /// "uniform from 0.2 to 0.5", for display.
    [[nodiscard]] std::string text() const;
    /// In the exact form that parse_distribution reads.
    [[nodiscard]] std::string written() const;
    /// The error in the numbers: "low must be below high"; empty if valid.
    [[nodiscard]] std::string problem() const;
};

/// Reads "0.2:0.5" (uniform), "log:0.01:1", "normal:0.4:0.05", "normal:0.4:0.05:0.2:0.6" (cut),
/// "triangular:0.2:0.3:0.5" (low, mode, high), "0.2,0.3,0.4" (list) or "400@3,900@1" (list with weights). Errors: none
/// of these, a number that does not parse, `problem()`.
[[nodiscard]] Result<Distribution> parse_distribution(std::string_view text);

/// "uniform", "log_uniform", "normal", "triangular", "list".
[[nodiscard]] const char* distribution_name(DistributionKind kind);

}  // namespace talus::stats
