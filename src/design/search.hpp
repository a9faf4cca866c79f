#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/result.hpp"

/// The least height that does what is wanted, by bisection of a grid of heights.
namespace talus::design {

/// `low`, `low` + `step`, ... up to `high`. Errors: not 0 < low <= high, a step that is not above 0, more than 1000.
[[nodiscard]] Result<std::vector<double>> height_grid(double low, double high, double step);

/// The first index from 0 to `count` - 1 for which `good` is true, if it is so for the last and if no good one has a
/// bad one above it; nothing: not for the last. Asks for few of them, each once.
[[nodiscard]] Result<std::optional<std::size_t>> least_index(std::size_t count,
                                                             const std::function<Result<bool>(std::size_t)>& good);

/// How many are asked for at most.
[[nodiscard]] std::size_t most_trials(std::size_t count);

}  // namespace talus::design
