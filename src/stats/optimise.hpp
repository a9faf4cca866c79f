#pragma once

#include <cstddef>
#include <functional>
#include <vector>

/// Minimisation of functions of a few variables, without derivatives: NLopt (Johnson, "The NLopt nonlinear-optimization
/// package") behind two calls. Deterministic: the same function gives the same result on every machine.
namespace talus::stats {

using Objective = std::function<double(const std::vector<double>&)>;

struct Optimum {
    std::vector<double> at;
    double value = 0;
};

/// A local minimum in the box from `start` on, by subspace-searching simplices (Rowan 1990). The limits have as many
/// numbers as `start`, which lies between them.
[[nodiscard]] Optimum minimise(const Objective& objective, const std::vector<double>& low,
                               const std::vector<double>& high, const std::vector<double>& start,
                               std::size_t evaluations);

/// The least value in the unit cube: the whole of it by dividing rectangles (Gablonsky & Kelley 2001), then locally
/// from the best of that and of `starts`. `evaluations`: of the whole; each local search may have a quarter as many.
[[nodiscard]] Optimum minimise_in_cube(const Objective& objective, std::size_t dimensions,
                                       const std::vector<std::vector<double>>& starts, std::size_t evaluations);

}  // namespace talus::stats
