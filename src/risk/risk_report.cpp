#include <algorithm>
#include <array>
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
#include "risk_report_files.hpp"

namespace talus::risk {

using namespace report;

namespace {

/// Risk is small: "1.3 × 10⁻⁵"; above a thousandth and below a million as usual.
std::string small(double value) {
    if (!std::isfinite(value)) return "–";
    if (value == 0) return "0";
    const double size = std::abs(value);
    if (size >= 1e-3 && size < 1e6) return significant(value, 2);
    static constexpr std::array<const char*, 10> raised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    const int exponent = static_cast<int>(std::floor(std::log10(size) + 1e-12));
    std::string power = exponent < 0 ? "⁻" : "";
    for (const char digit : std::to_string(std::abs(exponent)))
        power += raised.at(static_cast<std::size_t>(digit - '0'));
    return fmt::format("{} × 10{}", fixed(value / std::pow(10, exponent), 1), power);
}

/// A cell with the estimate and its interval below; null where there is none.
Json cell(const stats::Estimate& e, bool there) {
    if (!there) return {};
    if (e.low == e.high) return {{"value", small(e.value)}};
    return {{"value", small(e.value)}, {"note", fmt::format("{} – {}", small(e.low), small(e.high))}};
}
Json money(const stats::Estimate& e, bool there) {
    if (!there) return {};
    const auto text = [](double v) { return std::abs(v) >= 100 ? fixed(v, 0) : significant(v, 2); };
    if (e.low == e.high) return {{"value", text(e.value)}};
    return {{"value", text(e.value)}, {"note", fmt::format("{} – {}", text(e.low), text(e.high))}};
}

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

/// Impact as people ask for it: the probability in a year; per event it is a probability already.
stats::Estimate impact_of(const StudyResult& result, const ItemRisk& item) {
    return result.study->per_event ? item.impact : annual_probability(item.impact);
}

const Criteria* criteria_for(const StudyResult& result) {
    const bool deaths = result.risks.front().total.has_deaths && !result.study->per_event;
    return deaths ? criteria_of(result.scene().spec.risk.criteria) : nullptr;
}

std::string individual_tone(const StudyResult& result, double risk) {
    const Criteria* criteria = criteria_for(result);
    if (criteria == nullptr) return "";
    return risk > criteria->existing_individual ? "bad" : risk <= criteria->new_individual ? "good" : "";
}

std::vector<Column> item_columns(const StudyResult& result, bool difference) {
    const std::string unit = result.study->per();
    const std::string money = result.scene().spec.risk.currency + " " + unit;
    std::vector<Column> columns = {
        {"impact", difference ? "Events that reach something" : "Probability of impact", unit, "", "n"}};
    const ItemRisk& all = result.risks.front().total;
    if (all.has_loss) columns.push_back({"loss", "Expected loss", money, "", "n"});
    if (all.has_deaths) columns.push_back({"deaths", "Expected deaths", unit, "", "n"});
    if (all.has_individual && !difference) columns.push_back({"individual", "Individual risk", unit, "", "n"});
    return columns;
}

Json item_row(const StudyResult& result, const ItemRisk& item, bool difference) {
    Json row = {{"impact", cell(difference ? item.impact : impact_of(result, item), true)},
                {"loss", money(item.loss, item.has_loss)},
                {"deaths", cell(item.deaths, item.has_deaths)},
                {"individual", cell(item.individual, item.has_individual)}};
    if (!difference && item.has_individual) {
        const std::string tone = individual_tone(result, item.individual.value);
        if (!tone.empty()) row["individual"]["tone"] = tone;
    }
    return row;
}

Json table_of(const std::string& first, const std::vector<Column>& more) {
    std::vector<Column> columns = {{"name", first, ""}};
    columns.insert(columns.end(), more.begin(), more.end());
    return table(columns);
}

/// What is exposed, of the ground as it is: the worst first.
Json items_table(const StudyResult& result) {
    constexpr std::size_t most = 60;
    Json rows = table_of("Building or road", item_columns(result, false));
    std::vector<const ItemRisk*> items;
    for (const ItemRisk& item : result.risks.front().items) {
        if (item.impact.value > 0) items.push_back(&item);
    }
    std::stable_sort(items.begin(), items.end(), [](const ItemRisk* a, const ItemRisk* b) {
        return std::pair(a->individual.value, a->impact.value) > std::pair(b->individual.value, b->impact.value);
    });
    for (std::size_t k = 0; k < std::min(most, items.size()); ++k) {
        Json row = item_row(result, *items[k], false);
        row["name"] = {{"value", items[k]->name}, {"note", items[k]->road ? "road" : items[k]->exposure}};
        rows["rows"].push_back(std::move(row));
    }
    return rows["rows"].empty() ? Json() : rows;
}

/// Impact and individual risk of each item, side by side for all options.
Json side_by_side(const StudyResult& result) {
    if (result.risks.size() < 2) return {};
    const bool individual = result.risks.front().total.has_individual;
    std::vector<Column> columns;
    for (std::size_t k = 0; k < result.risks.size(); ++k) {
        columns.push_back({fmt::format("option_{}", k), result.name_of(k), "", "", "n"});
    }
    Json rows = table_of("Building or road", columns);
    for (std::size_t i = 0; i < result.risks.front().items.size(); ++i) {
        Json row = {{"name", result.risks.front().items[i].name}};
        bool any = false;
        for (std::size_t k = 0; k < result.risks.size(); ++k) {
            const ItemRisk& item = result.risks[k].items[i];
            any = any || item.impact.value > 0;
            Json shown = {{"value", small(impact_of(result, item).value)}};
            if (individual && item.has_individual) {
                shown["note"] = "risk " + small(item.individual.value);
                const std::string tone = individual_tone(result, item.individual.value);
                if (!tone.empty()) shown["note_tone"] = tone;
            }
            row[fmt::format("option_{}", k)] = std::move(shown);
        }
        if (any) rows["rows"].push_back(std::move(row));
    }
    return rows["rows"].empty() ? Json() : rows;
}

Json totals_table(const StudyResult& result) {
    std::vector<Column> columns = item_columns(result, false);
    if (criteria_for(result) != nullptr) columns.push_back({"region", "Societal risk", ""});
    Json rows = table_of(result.risks.size() > 1 ? "Option" : "", columns);
    for (std::size_t k = 0; k < result.risks.size(); ++k) {
        Json row = item_row(result, result.risks[k].total, false);
        row["name"] = result.name_of(k);
        if (const Criteria* criteria = criteria_for(result)) {
            const Region region = region_of(*criteria, result.risks[k].deaths_at_least);
            row["region"] = {{"value", region_text(region)}};
            if (region == Region::acceptable) row["region"]["tone"] = "good";
            if (region >= Region::unacceptable) row["region"]["tone"] = "bad";
        }
        rows["rows"].push_back(std::move(row));
    }
    return rows;
}

Json differences_table(const StudyResult& result) {
    if (result.risks.size() < 2) return {};
    Json rows = table_of("Option less as it is", item_columns(result, true));
    for (std::size_t k = 1; k < result.risks.size(); ++k) {
        Json row = item_row(result, result.differences[k].total, true);
        row["name"] = result.name_of(k);
        rows["rows"].push_back(std::move(row));
    }
    return rows;
}

/// Cost of a year against what it averts.
Json costs_table(const StudyResult& result) {
    if (result.risks.size() < 2 || result.study->per_event) return {};
    const std::string currency = result.scene().spec.risk.currency;
    const ItemRisk& all = result.risks.front().total;
    std::vector<Column> columns = {{"cost", "Cost", currency, "f0"},
                                   {"life", "Life", "years", "p"},
                                   {"yearly", "Cost of a year", currency + " per year", "f0"}};
    if (all.has_loss) columns.push_back({"averted", "Loss averted", currency + " per year", "f0"});
    if (all.has_loss) columns.push_back({"ratio", "Loss averted over cost", "", "s2"});
    if (all.has_deaths) columns.push_back({"lives", "Deaths averted", "per year", "", "n"});
    if (all.has_deaths) columns.push_back({"per_life", "Cost of a death averted", currency, "", "n"});
    Json rows = table_of("Option", columns);
    for (std::size_t k = 1; k < result.risks.size(); ++k) {
        const params::OptionSpec& option = *result.option(k);
        const ItemRisk& difference = result.differences[k].total;
        const double yearly = cost_per_year(option), averted = -difference.loss.value, lives = -difference.deaths.value;
        const double net = yearly - std::max(0.0, averted);
        const std::string per_life = !(lives > 0) ? "none averted"
                                     : net <= 0   ? "pays for itself"
                                                  : fixed(net / lives, 0);
        rows["rows"].push_back({{"name", option.name},
                                {"cost", option.cost},
                                {"life", option.life},
                                {"yearly", yearly},
                                {"averted", averted},
                                {"ratio", yearly > 0 ? Json(averted / yearly) : Json()},
                                {"lives", small(lives)},
                                {"per_life", per_life}});
    }
    return rows;
}

Json scenarios_table(const StudyResult& result) {
    const Study& study = *result.study;
    std::vector<Column> columns;
    if (!study.per_event) {
        columns.push_back({"frequency", "Frequency", "per year", "", "n"});
        columns.push_back({"period", "Return period", "years", "s3"});
    }
    columns.insert(
        columns.end(),
        {{"set", "Beside the scene", "", "", "code"}, {"runs", "Complete runs", "", "f0"}, {"source", "Source", ""}});
    Json rows = table_of("Class of events", columns);
    for (std::size_t s = 0; s < study.scenarios.size(); ++s) {
        const ScenarioOutcome& outcome = result.outcomes.front().scenarios[s];
        const auto complete =
            std::count_if(outcome.runs.begin(), outcome.runs.end(), [](const auto& r) { return r.has_value(); });
        rows["rows"].push_back({{"name", outcome.name},
                                {"frequency", small(outcome.frequency)},
                                {"period", 1 / outcome.frequency},
                                {"set", fmt::format("{}", fmt::join(study.scenarios[s].set, ", "))},
                                {"runs", complete},
                                {"source", study.scenarios[s].source}});
    }
    return rows;
}

Json factors_table(const StudyResult& result) {
    Json rows = table({{"key", "Factor", "", "", "code"}, {"distribution", "Distribution", ""}});
    for (const ensemble::Factor& factor : result.study->parts.front().runs->plan().factors) {
        rows["rows"].push_back({{"key", factor.key}, {"distribution", factor.distribution.text()}});
    }
    return rows;
}

/// The curves that the scene uses, with what was checked of them.
Json curves_table(const StudyResult& result) {
    Json rows =
        table({{"name", "Curve", "", "", "code"}, {"points", "Intensity: effect", ""}, {"source", "Source", ""}});
    const params::SceneSpec& spec = result.scene().spec;
    for (const Curve& curve : result.study->exposures.curves) {
        const bool used = curve.name == spec.risk.map_death_curve ||
                          std::any_of(spec.exposures.begin(), spec.exposures.end(), [&](const auto& e) {
                              return e.damage_curve == curve.name || e.death_curve == curve.name;
                          });
        if (!used) continue;
        std::string points;
        for (const auto& [x, y] : curve.points)
            points += fmt::format("{}{}: {}", points.empty() ? "" : ", ", plain(x), plain(y));
        rows["rows"].push_back(
            {{"name", {{"value", curve.name}, {"note", curve.title}}},
             {"points",
              {{"value", points},
               {"note", fmt::format("{} in {}",
                                    curve.effect == Effect::death ? "probability of death; intensity"
                                                                  : "share of the value lost; intensity",
                                    curve.unit())}}},
             {"source",
              {{"value", curve.source},
               {"note", curve.checked        ? "checked against its text"
                        : curve.note.empty() ? "not checked against its text"
                                             : curve.note}}}});
    }
    return rows["rows"].empty() ? Json() : rows;
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
    content.buildings.class_names = {"not hit, or not exposed", "up to 10⁻⁵ " + result.study->per(),
                                     "10⁻⁵ to 10⁻⁴ " + result.study->per(), "over 10⁻⁴ " + result.study->per()};
    const std::vector<ItemRisk>& items = result.risks.front().items;
    for (std::size_t b = 0; b < result.scene().buildings.size(); ++b) {
        const bool known = b < result.study->exposures.buildings.size();
        const double risk = known && items[b].has_individual ? items[b].individual.value : 0;
        content.buildings.classes.push_back(!(risk > 0) ? 0 : risk <= 1e-5 ? 1 : risk <= 1e-4 ? 2 : 3);
        content.buildings.titles.push_back(known ? fmt::format("{}: impact {}, individual risk {} {}", items[b].name,
                                                               small(impact_of(result, items[b]).value),
                                                               items[b].has_individual ? small(risk) : "–",
                                                               result.study->per())
                                                 : result.scene().buildings[b].name);
    }
    return content;
}

}  // namespace

Json risk_results(const StudyResult& result) {
    const Study& study = *result.study;
    std::vector<run::RunVerdict> verdicts;
    std::size_t failed = 0;
    for (const OptionOutcome& outcome : result.outcomes) {
        verdicts.push_back(outcome.verdict);
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
    TALUS_ASSIGN(page["maps"], map_figures(result.scene(), content));
    page["verdicts"] = Json::array({report::named_verdict("", results["verdict"])});
    page["fn"] = results["has_deaths"].get<bool>() ? Json{{"svg", fn_svg(result)}} : Json();
    return render(risk_report_files::risk_html, page);
}

}  // namespace talus::risk
