#include "risk_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/number_or_null.hpp"
#include "progress.hpp"
#include "report/results.hpp"
#include "risk/criteria.hpp"

namespace talus::cli {
namespace {

std::string with_interval(const stats::Estimate& e, bool there) {
    return there ? fmt::format("{:.3g} ({:.2g} to {:.2g})", e.value, e.low, e.high) : std::string("-");
}

std::string row(const std::string& name, const stats::Estimate& impact, const risk::ItemRisk& item) {
    return fmt::format("{:<28}{:>30}{:>30}{:>32}\n", name.substr(0, 27), with_interval(impact, true),
                       with_interval(item.loss, item.has_loss), with_interval(item.deaths, item.has_deaths));
}

}  // namespace

std::string cost_text(const risk::Study& study, std::size_t missing, double wall) {
    return fmt::format(
        "{} to make: {} x {}, {} each{}", report::plural(missing, "run"),
        report::plural(study.options.size(), "option"),
        study.scenarios.size() == 1 ? "1 class of events" : fmt::format("{} classes of events", study.scenarios.size()),
        study.parts.front().runs->count(), left_text("; about {} in all", wall));
}

std::string cost_json(const risk::Study& study, std::size_t missing, double wall) {
    const nlohmann::ordered_json json = {{"event", "cost"},
                                         {"runs", study.run_count()},
                                         {"runs_missing", missing},
                                         {"wall_time_s", number_or_null<nlohmann::ordered_json>(wall)}};
    return json.dump();
}

std::string risk_text(const risk::StudyResult& result, const std::filesystem::path& folder) {
    const std::string per = result.study->per_event ? "event" : "year";
    const std::string currency = result.scene().spec.risk.currency;
    std::string text = fmt::format("{:<28}{:>30}{:>30}{:>32}\n", "", "impact per " + per,
                                   "loss per " + per + (currency.empty() ? "" : ", " + currency), "deaths per " + per);
    const auto impact = [&](const risk::ItemRisk& item) {
        return result.study->per_event ? item.impact : risk::annual_probability(item.impact);
    };
    for (std::size_t k = 0; k < result.risks.size(); ++k) {
        text += row(result.name_of(k), impact(result.risks[k].total), result.risks[k].total);
    }
    for (std::size_t k = 1; k < result.risks.size(); ++k) {
        const risk::ItemRisk& change = result.differences[k].total;
        text += row(fmt::format("{} less as it is", result.name_of(k)), change.impact, change);
    }
    const risk::ItemRisk& all = result.risks.front().total;
    if (all.has_individual) {
        text += fmt::format("\nhighest individual risk per {}: {}\n", per, with_interval(all.individual, true));
    }
    const risk::Criteria* criteria = risk::criteria_of(result.scene().spec.risk.criteria);
    if (criteria != nullptr && all.has_deaths && !result.study->per_event) {
        for (std::size_t k = 0; k < result.risks.size(); ++k) {
            text += fmt::format("societal risk, {}: {} ({}; as from memory)\n", result.name_of(k),
                                region_text(region_of(*criteria, result.risks[k].deaths_at_least)), criteria->name);
        }
    }
    text += "In brackets: 95 %, for the number of runs alone. A licensed engineer checks and signs.\n";
    return text + fmt::format("\n{}\n", (folder / "report.html").string());
}

std::string risk_json(const risk::StudyResult& result, const std::filesystem::path& folder) {
    nlohmann::ordered_json json = {{"event", "result"}, {"folder", folder.string()}};
    json.update(risk_results(result));
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace talus::cli
