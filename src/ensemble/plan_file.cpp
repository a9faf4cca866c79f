#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/try.hpp"
#include "ensemble/plan.hpp"
#include "params/fields.hpp"
#include "scene/parse.hpp"
#include "scene/toml_file.hpp"

namespace talus::ensemble {
namespace {

/// Reads a plan's TOML; every unknown key is an error.
class PlanReader {
  public:
    explicit PlanReader(std::string name) : name_(std::move(name)) {}

    Result<EnsemblePlan> read(const toml::table& root) {
        for (const auto& [key, node] : root) {
            if (key.str() == "ensemble" && node.is_table()) {
                TALUS_TRY(read_ensemble(*node.as_table()));
            } else if (key.str() == "thresholds" && node.is_table()) {
                TALUS_TRY(read_thresholds(*node.as_table()));
            } else if (key.str() == "factor" && node.is_array_of_tables()) {
                for (const toml::node& entry : *node.as_array()) {
                    TALUS_TRY(read_factor(*entry.as_table()));
                }
            } else {
                return refused(key.source(), std::string(key.str()),
                               "is unknown; a plan has [ensemble], [thresholds] and [[factor]]");
            }
        }
        return plan_;
    }

  private:
    [[nodiscard]] Error refused(const toml::source_region& at, const std::string& what, const std::string& why) const {
        return Error{fmt::format("{}:{}: {} {}", name_, at.begin.line, scene::one_line(what, 120), why)};
    }
    [[nodiscard]] Error unknown(const toml::key& key, const std::vector<std::string>& known) const {
        return refused(key.source(), fmt::format("unknown key \"{}\";", key.str()),
                       "nearest known key: " + params::nearest_word(key.str(), known));
    }

    Status read_ensemble(const toml::table& table) {
        for (const auto& [key, node] : table) {
            const std::string what = fmt::format("ensemble.{} = {}", key.str(), scene::toml_text_of(node));
            if (key.str() == "design") {
                const auto name = node.value<std::string>();
                const auto design = name ? stats::design_of(*name) : std::nullopt;
                if (!design) {
                    return refused(
                        key.source(), what,
                        fmt::format("is refused; it must be one of {}", fmt::join(stats::design_names(), ", ")));
                }
                plan_.design = *design;
                continue;
            }
            if (key.str() == "return_period_years") {
                const auto years = node.value<double>();
                if (!years || !std::isfinite(*years) || !(*years > 0)) {
                    return refused(key.source(), what, "is refused; it must be a number above 0 (years)");
                }
                plan_.return_period = *years;
                continue;
            }
            const auto whole = node.value_exact<std::int64_t>();
            if (key.str() != "runs" && key.str() != "levels" && key.str() != "seed" && key.str() != "fast_runs") {
                return unknown(key, {"design", "runs", "fast_runs", "levels", "seed", "return_period_years"});
            }
            if (!whole || *whole < 0)
                return refused(key.source(), what, "is refused; it must be a whole number from 0");
            const auto number = static_cast<std::uint64_t>(*whole);
            if (key.str() == "runs") plan_.runs = number;
            if (key.str() == "fast_runs") plan_.fast_runs = number;
            if (key.str() == "levels") plan_.levels = number;
            if (key.str() == "seed") plan_.seed = number;
        }
        return {};
    }

    Status read_thresholds(const toml::table& table) {
        for (const auto& [key, node] : table) {
            std::vector<double>* values = key.str() == "depth_m"        ? &plan_.thresholds.depth
                                          : key.str() == "speed_mps"    ? &plan_.thresholds.speed
                                          : key.str() == "pressure_kPa" ? &plan_.thresholds.pressure
                                                                        : nullptr;
            if (values == nullptr) return unknown(key, {"depth_m", "speed_mps", "pressure_kPa"});
            std::string text;
            const toml::array* items = node.as_array();
            for (std::size_t i = 0; items != nullptr && i < items->size(); ++i) {
                text += fmt::format("{}{}", i > 0 ? "," : "", items->get(i)->value<double>().value_or(std::nan("")));
            }
            const std::string what = fmt::format("thresholds.{}", key.str());
            Result<std::vector<double>> parsed = parse_thresholds(text, what);
            if (!parsed) {
                return refused(key.source(), fmt::format("{} = {}", what, scene::toml_text_of(node)),
                               "is refused; it must be ascending numbers from 0, such as [0.5, 1]");
            }
            *values = *std::move(parsed);
        }
        return {};
    }

    Status read_factor(const toml::table& table) {
        Factor factor;
        std::string kind = "uniform";
        for (const auto& [key, node] : table) {
            const std::string what = fmt::format("factor.{} = {}", key.str(), scene::toml_text_of(node));
            if (key.str() == "key" || key.str() == "distribution") {
                const auto text = node.value_exact<std::string>();
                if (!text) return refused(key.source(), what, "is refused; it must be a text");
                (key.str() == "key" ? factor.key : kind) = *text;
            } else if (key.str() == "values") {
                const toml::array* items = node.as_array();
                if (items == nullptr || items->empty())
                    return refused(key.source(), what, "is refused; it must be a list of values");
                for (const toml::node& item : *items) {
                    const auto text = item.value_exact<std::string>();
                    factor.distribution.entries.push_back(text ? *text : scene::toml_text_of(item));
                }
                kind = "list";
            } else if (key.str() == "weights") {
                const toml::array* items = node.as_array();
                if (items == nullptr || items->empty())
                    return refused(key.source(), what, "is refused; it must be a list of numbers above 0");
                for (const toml::node& item : *items) {
                    factor.distribution.weights.push_back(item.value<double>().value_or(std::nan("")));
                }
            } else if (double* number = number_of(factor.distribution, key.str())) {
                const auto value = node.value<double>();
                if (!value || !std::isfinite(*value))
                    return refused(key.source(), what, "is refused; it must be a number");
                *number = *value;
            } else {
                return unknown(
                    key, {"key", "distribution", "low", "high", "mode", "mean", "deviation", "values", "weights"});
            }
        }
        if (factor.key.empty())
            return refused(table.source(), "factor.key",
                           "is missing; it must be a key of the scene, such as material.friction_coefficient");
        constexpr std::array kinds = {stats::DistributionKind::uniform, stats::DistributionKind::log_uniform,
                                      stats::DistributionKind::normal, stats::DistributionKind::triangular,
                                      stats::DistributionKind::list};
        bool known = false;
        for (const stats::DistributionKind k : kinds) {
            if (kind != distribution_name(k)) continue;
            factor.distribution.kind = k;
            known = true;
        }
        const std::string what = fmt::format("factor {}:", factor.key);
        if (!known) {
            return refused(
                table.source(), what,
                fmt::format(
                    "distribution \"{}\" is refused; it must be one of uniform, log_uniform, normal, triangular, list",
                    kind));
        }
        if (const std::string problem = factor.distribution.problem(); !problem.empty()) {
            return refused(table.source(), what, problem);
        }
        if (!factor.distribution.weights.empty() && factor.distribution.kind != stats::DistributionKind::list) {
            return refused(table.source(), what, "weights are those of values, which are not given");
        }
        const bool bounded = std::isfinite(factor.distribution.low) && std::isfinite(factor.distribution.high);
        if (!bounded && factor.distribution.kind != stats::DistributionKind::normal &&
            factor.distribution.kind != stats::DistributionKind::list) {
            return refused(table.source(), what, "low and high must be given");
        }
        plan_.factors.push_back(std::move(factor));
        return {};
    }

    static double* number_of(stats::Distribution& d, std::string_view key) {
        if (key == "low") return &d.low;
        if (key == "high") return &d.high;
        if (key == "mode" || key == "mean") return &d.middle;
        if (key == "deviation") return &d.deviation;
        return nullptr;
    }

    std::string name_;
    EnsemblePlan plan_;
};

}  // namespace

Result<EnsemblePlan> read_plan(const std::filesystem::path& file) {
    TALUS_ASSIGN(const toml::table root, scene::read_toml_file(file, "plan"));
    return PlanReader(file.string()).read(root);
}

}  // namespace talus::ensemble
