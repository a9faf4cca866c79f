#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

/// Positions of the runs of an ensemble in the unit cube. A design depends only on its kind, its size and the seed, so
/// that run 17 is the same run on any machine, shard or rank.
namespace talus::stats {

enum class DesignKind {
    monte_carlo,      ///< independent draws
    latin_hypercube,  ///< McKay, Beckman & Conover 1979: every factor takes each of n equal shares of its range once
    sobol,            ///< Sobol 1967 with the direction numbers of Joe & Kuo 2008, shifted digit by digit by the seed
    grid,             ///< every combination of levels
    saltelli,         ///< Saltelli et al. 2010: two Sobol samples and their mixtures, for first-order and total indices
    morris,           ///< Morris 1991: random trajectories that change one factor at a time
};

/// "monte_carlo", "latin_hypercube", ...
[[nodiscard]] const char* design_name(DesignKind kind);
[[nodiscard]] std::optional<DesignKind> design_of(std::string_view name);
[[nodiscard]] const std::vector<std::string_view>& design_names();

/// Maximum number of factors of a Sobol sequence (sobol; half as many for saltelli), limited by its direction numbers.
inline constexpr std::size_t sobol_dimensions = 21;

/// Levels of a factor that Morris's trajectories step between; a step is two of the four (Morris 1991).
inline constexpr std::size_t morris_levels = 4;

/// A number in (0, 1) from the seed and two counters: a bijective mixer (splitmix64, Steele, Lea & Flood 2014) of all
/// three, so that no draw depends on those before it.
[[nodiscard]] double draw(std::uint64_t seed, std::uint64_t row, std::uint64_t column);

/// Points of the unit cube, one row per run.
using Points = std::vector<std::vector<double>>;

/// monte_carlo, latin_hypercube or sobol: `count` rows of `factors` numbers.
[[nodiscard]] Points sample_points(DesignKind kind, std::size_t count, std::size_t factors, std::uint64_t seed);

/// Every combination of levels: factor k takes (j + 1/2) / levels[k]; the last factor changes fastest.
[[nodiscard]] Points grid_points(const std::vector<std::size_t>& levels);

/// `rows` blocks of factors + 2 runs: a row of sample A, the same of B, then A with factor k of B for every k.
[[nodiscard]] Points saltelli_points(std::size_t rows, std::size_t factors, std::uint64_t seed);

/// `trajectories` blocks of factors + 1 runs, each of which changes one factor of the run before.
[[nodiscard]] Points morris_points(std::size_t trajectories, std::size_t factors, std::uint64_t seed);

}  // namespace talus::stats
