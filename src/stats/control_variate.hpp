#pragma once

#include <vector>

namespace talus::stats {

/// The mean of a slow model's numbers, and the same with the help of a fast model that was run more often.
struct ControlledMean {
    double plain = 0, plain_error = 0;  ///< of the slow model's runs alone, with its standard error
    double mean = 0, error = 0;         ///< with the fast model's; as plain where these do not help
    double factor = 0;                  ///< on the fast model's difference; 0: they do not help
};

/// The control variate with a mean that is itself estimated (Peherstorfer, Willcox & Gunzburger 2016, "Optimal model
/// management for multifidelity Monte Carlo estimation", SIAM Journal on Scientific Computing 38, section 2.2): the
/// slow mean plus a factor times the difference between the fast model's means over all its runs and over those at the
/// places of the slow ones. The factor is the regression's, and the standard error grows by that of estimating it
/// (Lavenberg, Moeller & Welch 1982). Errors are those of independent draws. `slow`, `fast`: at the same places, at
/// least two; `more`: of the fast model at others.
[[nodiscard]] ControlledMean controlled_mean(const std::vector<double>& slow, const std::vector<double>& fast,
                                             const std::vector<double>& more);

}  // namespace talus::stats
