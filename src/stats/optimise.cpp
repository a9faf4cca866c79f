#include "stats/optimise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlopt.h>

namespace talus::stats {
namespace {

/// The objective as NLopt calls it. It keeps the best point itself, which NLopt's last one need not be.
struct Search {
    const Objective& objective;
    Optimum best;
    std::vector<double> at;

    static double call(unsigned count, const double* x, double*, void* data) {
        auto& search = *static_cast<Search*>(data);
        search.at.assign(x, x + count);
        const double value = search.objective(search.at);
        if (!std::isfinite(value)) return 1e300;  // NLopt compares values, which fails for NaN
        if (value < search.best.value) search.best = {search.at, value};
        return value;
    }
};

Optimum run(nlopt_algorithm algorithm, const Objective& objective, const std::vector<double>& low,
            const std::vector<double>& high, std::vector<double> at, std::size_t evaluations) {
    Search search{objective, {at, std::numeric_limits<double>::infinity()}, {}};
    const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser(
        nlopt_create(algorithm, static_cast<unsigned>(at.size())), nlopt_destroy);
    nlopt_set_min_objective(optimiser.get(), Search::call, &search);
    nlopt_set_lower_bounds(optimiser.get(), low.data());
    nlopt_set_upper_bounds(optimiser.get(), high.data());
    nlopt_set_maxeval(optimiser.get(), static_cast<int>(evaluations));
    nlopt_set_xtol_rel(optimiser.get(), 1e-5);
    nlopt_set_ftol_abs(optimiser.get(), 1e-9);
    double value = 0;
    (void)nlopt_optimize(optimiser.get(), at.data(), &value);  // the best point is valid whatever ended the search
    return search.best;
}

}  // namespace

Optimum minimise(const Objective& objective, const std::vector<double>& low, const std::vector<double>& high,
                 const std::vector<double>& start, std::size_t evaluations) {
    return run(NLOPT_LN_SBPLX, objective, low, high, start, evaluations);
}

Optimum minimise_in_cube(const Objective& objective, std::size_t dimensions,
                         const std::vector<std::vector<double>>& starts, std::size_t evaluations) {
    const std::vector<double> low(dimensions, 0.0), high(dimensions, 1.0);
    Optimum best = run(NLOPT_GN_DIRECT_L, objective, low, high, std::vector<double>(dimensions, 0.5), evaluations);
    std::vector<std::vector<double>> from = starts;
    from.push_back(best.at);
    for (const std::vector<double>& start : from) {
        Optimum local = minimise(objective, low, high, start, std::max<std::size_t>(20, evaluations / 4));
        if (local.value < best.value) best = std::move(local);
    }
    return best;
}

}  // namespace talus::stats
