#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "ensemble/ensemble.hpp"
#include "ensemble_text.hpp"
#include "risk/risk_products.hpp"
#include "risk/study.hpp"

/// What `talus risk` and `talus options` print.
namespace talus::cli {

/// `missing`: runs still to be made; `wall`: s, for all of them; NaN: not known.
[[nodiscard]] std::string cost_text(const risk::Study& study, std::size_t missing, double wall);
[[nodiscard]] std::string cost_json(const risk::Study& study, std::size_t missing, double wall);

[[nodiscard]] std::string risk_text(const risk::StudyResult& result, const std::filesystem::path& folder);
[[nodiscard]] std::string risk_json(const risk::StudyResult& result, const std::filesystem::path& folder);

}  // namespace talus::cli
