#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "ensemble/ensemble_products.hpp"

/// An ensemble's results as tables.
namespace talus::ensemble {

inline constexpr std::array<double, 9> table_percentiles = {1, 5, 10, 25, 50, 75, 90, 95, 99};

/// The names of a building's numbers in tables and vectors, and the numbers in their order.
[[nodiscard]] std::vector<std::string> building_columns(const EnsembleResult& result);
[[nodiscard]] std::vector<double> building_numbers(const BuildingOdds& building);

/// Writes runs.csv, buildings.csv, distributions.csv, sensitivity.csv and, where two models were run, two_models.csv.
[[nodiscard]] Status write_ensemble_tables(const EnsembleResult& result, const std::filesystem::path& folder);

}  // namespace talus::ensemble
