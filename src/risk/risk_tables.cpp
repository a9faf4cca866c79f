#include "risk/risk_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "report/number_text.hpp"

namespace talus::risk {

using report::Column;
using report::fixed;
using report::Json;
using report::plain;
using report::significant;
using report::table;

std::string small(double value) {
    if (!std::isfinite(value)) return "–";
    if (value == 0) return "0";
    const double size = std::abs(value);
    if (size >= 1e-3 && size < 1e6) return significant(value, 2);
    static constexpr std::array<const char*, 10> raised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    const std::string text = fmt::format("{:.1e}", value);
    const std::size_t e = text.find('e');
    const int exponent = std::stoi(text.substr(e + 1));
    std::string power = exponent < 0 ? "⁻" : "";
    for (const char digit : std::to_string(std::abs(exponent))) {
        power += raised.at(static_cast<std::size_t>(digit - '0'));
    }
    return fmt::format("{}{} × 10{}", value < 0 ? "−" : "", text.substr(value < 0 ? 1 : 0, e - (value < 0 ? 1 : 0)),
                       power);
}

stats::Estimate impact_of(const StudyResult& result, const ItemRisk& item) {
    return result.study->per_event ? item.impact : annual_probability(item.impact);
}

const Criteria* criteria_for(const StudyResult& result) {
    const bool deaths = result.risks.front().total.has_deaths && !result.study->per_event;
    return deaths ? criteria_of(result.scene().spec.risk.criteria) : nullptr;
}

namespace {

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

}  // namespace

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

}  // namespace talus::risk
