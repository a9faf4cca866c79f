#pragma once

#include <cstddef>
#include <vector>

#include "stats/design.hpp"

/// Which factors a scalar result depends on.
namespace talus::stats {

enum class SensitivityKind {
    variance,   ///< Sobol indices, from a saltelli design
    screening,  ///< elementary effects, from a morris design
    rank,       ///< Spearman's rank correlation, from any other
};

/// An index and the interval that holds 95 % of its values under resampling.
struct Estimate {
    double value = 0, low = 0, high = 0;
};

struct FactorEffect {
    /// variance: share of the variance that is removed by fixing this factor alone (Saltelli et al. 2010, table 2 b),
    /// and that remains when all others are fixed (Jansen 1999).
    Estimate first, total;
    /// screening: mean of absolute elementary effects (Campolongo et al. 2007), their mean and standard deviation, as
    /// change of the result over the factor's whole range.
    double mean_size = 0, mean = 0, deviation = 0;
    /// rank: -1 to 1.
    double correlation = 0;
};

struct Sensitivity {
    SensitivityKind kind = SensitivityKind::rank;
    std::size_t used = 0;               ///< blocks (variance, screening) or runs that have a result
    std::vector<FactorEffect> effects;  ///< per factor; empty: too few runs, or the result never changes
};

/// `results`: one per run of the plan, NaN where a run failed, is missing or gave none. An incomplete block is ignored.
[[nodiscard]] Sensitivity sensitivity_of(DesignKind design, const Points& points, const std::vector<double>& results);

}  // namespace talus::stats
