#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/page.hpp"
#include "report/results.hpp"
#include "report/table.hpp"
#include "risk/criteria.hpp"
#include "risk/risk_products.hpp"
#include "risk/risk_tables.hpp"
#include "risk_report_files.hpp"

namespace talus::risk {

using report::HazardMap;
using report::Json;
using report::key_figure;
using report::MapContent;
using report::plain;
using report::results_head;

namespace {

/// The same as numbers, for programs.
Json numbers(const stats::Estimate& e, bool there) {
    if (!there) return {};
    return {{"value", e.value}, {"low", e.low}, {"high", e.high}};
}
Json item_numbers(const ItemRisk& item) {
    return {{"name", item.name},
            {"exposure", item.exposure},
            {"road", item.road},
            {"impacts", numbers(item.impact, true)},
            {"loss", numbers(item.loss, item.has_loss)},
            {"deaths", numbers(item.deaths, item.has_deaths)},
            {"individual_risk", numbers(item.individual, item.has_individual)}};
}

Json key_figures_of(const StudyResult& result) {
    const ItemRisk& all = result.risks.front().total;
    Json figures = Json::array();
    const auto add = [&](const char* key, const char* name, const std::string& value, const std::string& unit,
                         const std::string& note,
                         bool alert) { figures.push_back(key_figure(key, name, value, "", unit, note, alert)); };
    const auto interval = [](const stats::Estimate& e) {
        return e.low == e.high ? std::string("no run differs")
                               : fmt::format("95 %: {} to {}", small(e.low), small(e.high));
    };
    const stats::Estimate impact = impact_of(result, all);
    add("impact", "Probability that something is hit", small(impact.value), result.study->per(), interval(impact),
        false);
    if (all.has_loss) {
        add("loss", "Expected loss", small(all.loss.value),
            result.scene().spec.risk.currency + " " + result.study->per(), interval(all.loss), false);
    }
    if (all.has_individual) {
        const Criteria* criteria = criteria_for(result);
        const bool over = criteria != nullptr && all.individual.value > criteria->existing_individual;
        add("individual_risk", "Highest individual risk", small(all.individual.value), result.study->per(),
            criteria == nullptr ? interval(all.individual)
                                : fmt::format("limits {} (existing), {} (new)", small(criteria->existing_individual),
                                              small(criteria->new_individual)),
            over);
    }
    if (all.has_deaths) {
        add("deaths", "Expected deaths", small(all.deaths.value), result.study->per(), interval(all.deaths), false);
    }
    return figures;
}

Json criteria_json(const StudyResult& result) {
    const Criteria* criteria = criteria_for(result);
    if (criteria == nullptr) return {};
    return {{"name", criteria->name},
            {"source", criteria->source},
            {"existing", small(criteria->existing_individual)},
            {"new", small(criteria->new_individual)},
            {"unacceptable", small(criteria->unacceptable_at_1)},
            {"acceptable", small(criteria->acceptable_at_1)},
            {"most_deaths", plain(criteria->most_deaths)}};
}

/// A map in numbers that people read: millionths of deaths, events in a thousand years.
HazardMap readable(HazardMap style, double factor, const std::string& unit) {
    style.factor = factor;
    style.unit = unit;
    for (double& value : style.breaks) value *= factor;
    style.full_scale *= factor;
    return style;
}

MapContent content_of(const StudyResult& result) {
    MapContent content;
    const bool event = result.study->per_event;
    content.reached = &result.outcomes.front().debris;
    for (std::size_t k = 0; k < result.outcomes.size(); ++k) {
        const OptionOutcome& outcome = result.outcomes[k];
        const std::string tab = result.outcomes.size() > 1 ? result.name_of(k) : "";
        if (!outcome.individual.values.empty()) {
            content.layers.push_back(
                {readable(individual_style(result, k), 1e6, event ? "10⁻⁶ per event" : "10⁻⁶ per year"),
                 &outcome.individual, tab.empty() ? "Individual risk" : "Risk: " + tab,
                 fmt::format("Probability of death {} of a person who is always there, in millionths.",
                             result.study->per()),
                 1});
        }
        content.layers.push_back({event ? readable(debris_style(result, k), 100, "%")
                                        : readable(debris_style(result, k), 1000, "events in 1000 years"),
                                  &outcome.debris, tab.empty() ? "Debris" : "Debris: " + tab,
                                  "How often debris comes there.", 2});
    }
    content.cell = content.reached->geometry.cell;
    content.farthest_chainage = std::numeric_limits<double>::quiet_NaN();
    content.buildings.title = "Individual risk in buildings";
    content.buildings.class_names = {"not hit, or not exposed", std::string("up to 10⁻⁵ ") + result.study->per(),
                                     std::string("10⁻⁵ to 10⁻⁴ ") + result.study->per(),
                                     std::string("over 10⁻⁴ ") + result.study->per()};
    const std::vector<ItemRisk>& items = result.risks.front().items;
    std::size_t next = 0;  // the order is that of the scene, of which an option in force may have removed some
    for (const terrain::Building& building : result.scene().buildings) {
        while (!building.barrier && next < items.size() && items[next].name != building.name) ++next;
        if (building.barrier || next == items.size()) {
            content.buildings.classes.push_back(0);
            content.buildings.titles.push_back(building.name);
            continue;
        }
        const ItemRisk& item = items[next++];
        const double risk = item.has_individual ? item.individual.value : 0;
        content.buildings.classes.push_back(!(risk > 0) ? 0 : risk <= 1e-5 ? 1 : risk <= 1e-4 ? 2 : 3);
        content.buildings.titles.push_back(fmt::format("{}: impact {}, individual risk {} {}", item.name,
                                                       small(impact_of(result, item).value),
                                                       item.has_individual ? small(risk) : "–", result.study->per()));
    }
    return content;
}

}  // namespace

Json risk_results(const StudyResult& result) {
    const Study& study = *result.study;
    std::vector<run::RunVerdict> verdicts;
    std::size_t failed = 0;
    for (const OptionOutcome& outcome : result.outcomes) {
        verdicts.insert(verdicts.end(), outcome.verdicts.begin(), outcome.verdicts.end());
        failed += outcome.failed;
    }
    const run::RunVerdict verdict = run::judge_together(verdicts);
    const bool options = study.options.size() > 1;
    Json all = results_head(options ? "talus options" : "talus risk", result.scene());
    Json numbers_of_options = Json::array();
    for (std::size_t k = 0; k < result.risks.size(); ++k) {
        Json items = Json::array();
        for (const ItemRisk& item : result.risks[k].items) items.push_back(item_numbers(item));
        Json one = {{"name", result.name_of(k)},
                    {"items", std::move(items)},
                    {"total", item_numbers(result.risks[k].total)},
                    {"deaths_at_least", result.risks[k].deaths_at_least},
                    {"difference", nullptr},
                    {"cost_per_year", nullptr}};
        if (k > 0) {
            one["difference"] = item_numbers(result.differences[k].total);
            one["cost_per_year"] = cost_per_year(*result.option(k));
        }
        numbers_of_options.push_back(std::move(one));
    }
    all.update(
        {{"status", {{"name", "complete"}, {"partial", false}, {"beyond_limits", report::beyond_limits(verdict)}}},
         {"verdict", verdict_json(verdict)},
         {"per", study.per_event ? "event" : "year"},
         {"per_event", study.per_event},
         {"currency", result.scene().spec.risk.currency},
         {"runs", study.run_count()},
         {"failed", failed},
         {"any_failed", failed > 0},
         {"key_figures", key_figures_of(result)},
         {"has_options", options},
         {"has_deaths", result.risks.front().total.has_deaths && !study.per_event},
         {"totals", totals_table(result)},
         {"differences", differences_table(result)},
         {"costs", costs_table(result)},
         {"scenarios", scenarios_table(result)},
         {"factors", factors_table(result)},
         {"items", items_table(result)},
         {"side_by_side", side_by_side(result)},
         {"criteria", criteria_json(result)},
         {"curves", curves_table(result)},
         {"assumptions", assumptions_of(result)},
         {"limits", limits_of(result)},
         {"options", std::move(numbers_of_options)}});
    return all;
}

Result<std::string> risk_report(const StudyResult& result, const Json& results) {
    MapContent content = content_of(result);
    if (!results["status"]["beyond_limits"].is_null()) content.beyond_limits = results["status"]["beyond_limits"];
    Json page = results;
    page["report_name"] = result.study->options.size() > 1 ? "options" : "risk";
    page["masthead"] = result.study->options.size() > 1 ? "Options compared" : "Landslide risk";
    TALUS_ASSIGN(page["maps"], report::map_figures(result.scene(), content));
    page["verdicts"] = Json::array({report::named_verdict("", results["verdict"])});
    page["fn"] = results["has_deaths"].get<bool>() ? Json{{"svg", fn_svg(result)}} : Json();
    return report::render(risk_report_files::risk_html, page);
}

}  // namespace talus::risk
