#include "run/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "observe/number_names.hpp"
#include "run/words.hpp"

namespace talus::run {
namespace {

struct Measure {
    Quantity quantity;
    std::function<double(const observe::Observation&)> value;
    const observe::NamedPeak* peak = nullptr;                    // of the maps, in place of `value`
    std::function<bool(const observe::Observation&)> same = {};  // where a number alone is not enough: whether it is
                                                                 // the same as in the base
};

double value_in(const Measure& measure, const observe::Observation& observation, const observe::Peaks& peaks) {
    return measure.peak ? measure.peak->value(peaks) : measure.value(observation);
}

double first_building_hit(const observe::Observation& observation) {
    double first = observe::never;
    for (const observe::BuildingImpact& building : observation.buildings) {
        if (building.hit) first = std::fmin(first, building.first_hit_time);  // fmin ignores NaN
    }
    return first;
}

Measure at_observation(const scene::Scene& scene, const params::ObservationSpec& observed) {
    Measure m;
    m.quantity = {.key = fmt::format("{}_at_{:g}_m", observed.key(), observed.chainage),
                  .suffix = "mps",
                  .name = fmt::format("{} at {:g} m", observed.debris_speed ? "debris speed" : "front velocity",
                                      observed.chainage),
                  .unit = "m/s",
                  .not_measured = scene.flow_path.empty() ? "the scene has no flow path"
                                                          : "the front did not get there, or jumped along the path"};
    m.value = [observed](const observe::Observation& o) { return computed_for(observed, o); };
    return m;
}

/// The chainage, in whole intervals of front.csv, at 90 % of the front's run in the base.
double late_chainage(const scene::Scene& scene, const observe::Observation& base) {
    const double interval = scene.spec.outputs.chainage_interval;
    return interval * std::floor(0.9 * base.run_out.front_chainage / interval);
}

Measure arrival(const scene::Scene& scene, const observe::Observation& base) {
    Measure m;
    m.quantity.suffix = m.quantity.unit = "s";
    const bool hit = std::isfinite(first_building_hit(base));
    const double chainage = late_chainage(scene, base);
    if (hit || !std::isfinite(chainage)) {
        m.quantity.key = "first_building_hit";
        m.quantity.name = "first building hit";
        m.quantity.not_measured = "no building was hit and no front was seen along a flow path";
        m.value = first_building_hit;
    } else {
        m.quantity.key = fmt::format("front_arrival_at_{:g}_m", chainage);
        m.quantity.name = fmt::format("front arrival at {:g} m", chainage);
        m.quantity.not_measured = "the front started beyond";
        m.value = [chainage](const observe::Observation& o) { return front_at(o, chainage).arrival_time; };
    }
    return m;
}

/// Of a number whose key ends with its unit.
Quantity quantity_of(std::string_view key, const char* title, const char* unit, const char* not_measured) {
    const std::size_t cut = key.rfind('_');
    return {.key = std::string(key.substr(0, cut)),
            .suffix = std::string(key.substr(cut + 1)),
            .name = uncapitalised(title),
            .unit = std::string(observe::printed_unit(unit)),
            .not_measured = not_measured};
}

/// Run-out, and area and depth of the deposit.
void add_deposit(std::vector<Measure>& all) {
    all.push_back({{"run_out", "m", "run-out", "m", 5, observe::never, "no debris is left to measure"},
                   observe::run_out_number.value});
    for (const observe::NamedNumber& number : observe::deposit_numbers) {
        all.push_back({quantity_of(number.key, number.title, number.unit, "nothing was deposited"),
                       [value = number.value](const observe::Observation& o) {
                           return o.deposit.area > 0 ? value(o) : observe::never;
                       }});
        all.back().quantity.limit_percent = 10;
    }
}

double largest_force(const observe::Observation& observation) {
    double largest = 0;
    for (const observe::BuildingImpact& b : observation.buildings) largest = std::max(largest, b.peak_force);
    return largest;
}

/// Indices of the buildings on which the force was a sufficient share of the largest.
std::vector<std::size_t> counting_hits(const observe::Observation& observation) {
    const double least = counting_force_share * largest_force(observation);
    std::vector<std::size_t> hits;
    for (std::size_t i = 0; i < observation.buildings.size(); ++i) {
        const observe::BuildingImpact& b = observation.buildings[i];
        if (b.hit && b.peak_force >= least) hits.push_back(i);
    }
    return hits;
}

void add_buildings(const observe::Observation& base, std::vector<Measure>& all) {
    const std::vector<std::size_t> hits = counting_hits(base);
    for (const bool barriers : {false, true}) {
        if (hits_among(base.buildings, barriers).all == 0) continue;
        const auto hits_in = [barriers](const observe::Observation& o) {
            std::vector<std::size_t> list = counting_hits(o);
            std::erase_if(list, [&](std::size_t i) { return o.buildings[i].is_barrier != barriers; });
            return list;
        };
        Measure list;
        list.quantity = {.key = barriers ? "barriers_hit" : "buildings_hit",
                         .suffix = "count",
                         .name = barriers ? "barriers hit" : "buildings hit",
                         .unit = "",
                         .limit_percent = 0,
                         .not_measured = barriers ? "no barrier was hit" : "no building was hit"};
        list.value = [hits_in](const observe::Observation& o) {
            const std::size_t count = hits_in(o).size();
            return count > 0 ? static_cast<double>(count) : observe::never;
        };
        list.same = [hits_in, of_base = hits_in(base)](const observe::Observation& o) { return hits_in(o) == of_base; };
        all.push_back(std::move(list));
    }
    for (const std::size_t i : hits) {
        const std::string name = base.buildings[i].name;
        const auto add = [&](const char* key, const char* suffix, const char* what, const char* unit, double scale,
                             double observe::BuildingImpact::*member) {
            Measure m;
            m.quantity = {.key = fmt::format("{}_{}", key, i),
                          .suffix = suffix,
                          .name = fmt::format("{} on {}", what, name),
                          .unit = unit,
                          .limit_percent = 15};
            m.value = [=](const observe::Observation& o) {
                return i < o.buildings.size() && o.buildings[i].hit ? o.buildings[i].*member / scale : observe::never;
            };
            all.push_back(std::move(m));
        };
        add("peak_force", "kN", "force", "kN", 1e3, &observe::BuildingImpact::peak_force);
        add("peak_impact_pressure", "kPa", "impact pressure", "kPa", 1e3,
            &observe::BuildingImpact::peak_impact_pressure);
    }
}

std::vector<Measure> measures(ComparisonKind kind, const scene::Scene& scene, const observe::Observation& base,
                              const observe::Peaks& peaks) {
    std::vector<Measure> all;
    for (const params::ObservationSpec& observed : scene.spec.observations) {
        Measure m = at_observation(scene, observed);
        const bool twice =
            std::any_of(all.begin(), all.end(), [&](const Measure& a) { return a.quantity.key == m.quantity.key; });
        if (!twice) all.push_back(std::move(m));
    }
    all.push_back(arrival(scene, base));
    add_deposit(all);
    if (kind == ComparisonKind::sensitivity) {
        // Peaks are those of single cells: no measure of convergence.
        for (const observe::NamedPeak& peak : observe::peak_numbers) {
            all.push_back(
                {quantity_of(peak.key, peak.map.title, peak.map.unit, "debris reached no map cell"), {}, &peak});
        }
    }
    if (kind == ComparisonKind::convergence && !base.buildings.empty()) add_buildings(base, all);
    for (Measure& m : all) {
        m.quantity.base = value_in(m, base, peaks);
        if (std::isfinite(m.quantity.base)) m.quantity.not_measured.clear();
    }
    return all;
}

Change change_from(const Measure& measure, const observe::Observation& observation, const observe::Peaks& peaks) {
    const double base = measure.quantity.base, value = value_in(measure, observation, peaks);
    Change change{value, observe::never, Verdict::fail};
    if (!std::isfinite(base) && !std::isfinite(value)) {
        change.verdict = Verdict::not_measured;
    } else if (base == value) {
        change.percent = 0;
        change.verdict = Verdict::pass;
    } else if (std::isfinite(base) && std::isfinite(value) && base != 0) {
        change.percent = 100 * (value - base) / std::abs(base);
        if (std::abs(change.percent) <= measure.quantity.limit_percent) change.verdict = Verdict::pass;
    }
    if (measure.same && !measure.same(observation)) change.verdict = Verdict::fail;
    return change;
}

struct Counts {
    std::size_t pass = 0, fail = 0, missing_runs = 0;
};

Counts count(const Comparison& comparison) {
    Counts counts;
    for (const Comparison::Row& row : comparison.rows) {
        counts.missing_runs += row.run.result ? 0 : 1;
        for (const Change& change : row.changes) {
            counts.pass += change.verdict == Verdict::pass ? 1 : 0;
            counts.fail += change.verdict == Verdict::fail ? 1 : 0;
        }
    }
    return counts;
}

}  // namespace

const char* verdict_name(Verdict verdict) {
    switch (verdict) {
        case Verdict::pass:
            return "pass";
        case Verdict::fail:
            return "fail";
        case Verdict::not_measured:
            return "not measured";
        case Verdict::missing:
            break;
    }
    return "missing";
}

Verdict Comparison::Row::verdict() const {
    if (!run.result) return Verdict::missing;
    const auto any = [&](Verdict wanted) {
        return std::any_of(changes.begin(), changes.end(), [&](const Change& c) { return c.verdict == wanted; });
    };
    return any(Verdict::fail) ? Verdict::fail : any(Verdict::pass) ? Verdict::pass : Verdict::not_measured;
}

bool Comparison::all_ran() const {
    return std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.run.result.has_value(); });
}

Answer Comparison::converged() const {
    const Counts counts = count(*this);
    if (counts.fail > 0) return Answer::no;
    return counts.missing_runs > 0 || counts.pass == 0 ? Answer::unknown : Answer::yes;
}

std::string Comparison::verdict_text() const {
    const Counts counts = count(*this);
    std::string missing =
        counts.missing_runs > 0 ? fmt::format("{} of {} runs missing", counts.missing_runs, rows.size()) : "";
    if (kind == ComparisonKind::sensitivity) {
        if (!missing.empty()) return missing;
        const bool single =
            std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.run.variant.overrides.size() == 1; });
        return fmt::format("{} variants{}", rows.size(), single ? ", one value changed in each" : "");
    }
    const std::size_t all = counts.pass + counts.fail;
    switch (converged()) {
        case Answer::yes:
            return fmt::format("converged: none of {} changes above its limit", all);
        case Answer::no:
            return fmt::format("not converged: {} of {} changes above {} limit{}", counts.fail, all,
                               counts.fail == 1 ? "its" : "their", missing.empty() ? "" : ", " + missing);
        case Answer::unknown:
            break;
    }
    return "convergence not known: " + (missing.empty() ? "nothing could be measured" : missing);
}

Comparison compare(ComparisonKind kind, const scene::Scene& scene, const RunResult& base,
                   std::vector<VariantRun> runs) {
    const std::vector<Measure> all =
        measures(kind, scene, base.observation, observe::measure_peaks(base.observation.maps));
    Comparison comparison;
    comparison.kind = kind;
    for (const Measure& m : all) comparison.quantities.push_back(m.quantity);
    for (VariantRun& run : runs) {
        Comparison::Row row{std::move(run), {}};
        for (const Measure& m : all) {
            row.changes.push_back(row.run.result ? change_from(m, row.run.result->observation, row.run.peaks)
                                                 : Change{});
        }
        comparison.rows.push_back(std::move(row));
    }
    return comparison;
}

}  // namespace talus::run
