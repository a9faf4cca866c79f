#include "risk/study.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "ensemble/run_record.hpp"
#include "params/fields.hpp"
#include "scene/parse.hpp"

namespace talus::risk {
namespace {

namespace fs = std::filesystem;

/// A name as part of a folder's; numbers make it unique.
std::string folder_name(const std::string& name) {
    std::string made;
    for (const char c : name) {
        const auto u = static_cast<unsigned char>(c);
        made += std::isalnum(u) != 0 && u < 128 ? static_cast<char>(std::tolower(u)) : '_';
    }
    return made.substr(0, 40);
}

run::SceneSource with(const run::SceneSource& source, const std::vector<std::string>& more, const std::string& option) {
    run::SceneSource made = source;
    made.overrides.insert(made.overrides.end(), more.begin(), more.end());
    made.overrides.push_back("scene.option=" + (option.empty() ? "none" : params::toml_text(option)));
    return made;
}

Status check_request(const StudyRequest& request, const scene::Scene& base) {
    const std::string file = base.file.string();
    for (const ensemble::Factor& factor : request.plan.factors) {
        if (factor.key == "scene.option") {
            return Error{"factor scene.option is refused; options are compared, not drawn: talus options"};
        }
    }
    for (const params::RiskScenarioSpec& scenario : base.spec.risk_scenarios) {
        for (const std::string& set : scenario.set) {
            if (!set.starts_with("scene.option")) continue;
            return Error{fmt::format("{}: risk_scenario \"{}\" sets scene.option; an event does not build measures",
                                     file, scenario.name)};
        }
    }
    if (!request.needs_risk) return {};
    if (base.spec.risk_scenarios.empty()) {
        return Error{file + ": [[risk_scenario]] is missing; risk needs the classes of events and how often they come"};
    }
    if (base.spec.exposures.empty()) return Error{file + ": [[exposure]] is missing; it says what is at risk"};
    return {};
}

Result<Part> make_part(const StudyRequest& request, const scene::Scene& base, const Study& study, std::size_t option,
                       std::size_t scenario) {
    const params::RiskScenarioSpec& of = study.scenarios[scenario];
    Part part;
    part.option = study.options[option];
    part.scenario = scenario;
    part.source = with(request.source, of.set, part.option);
    const auto about = [&](const Error& error) {
        return study.per_event ? error : Error{fmt::format("risk_scenario \"{}\": {}", of.name, error.message)};
    };
    auto loaded = scene::load_scene(part.source.file, part.source.overrides);
    if (!loaded) return about(loaded.error());
    part.scene = std::make_shared<const scene::Scene>(*std::move(loaded));
    ensemble::EnsemblePlan plan = request.plan;
    plan.seed += scenario;  // independent draws: their errors do not add up
    if (!study.per_event) plan.return_period = 1 / study.frequency(scenario);
    auto runs = ensemble::PlannedRuns::make(plan, part.source, base);
    if (!runs) return about(runs.error());
    part.runs = std::make_shared<const ensemble::PlannedRuns>(*std::move(runs));
    // Its number in the scene, so that some of the options share their runs with all of them.
    const auto& all = base.spec.options;
    const auto place = std::find_if(all.begin(), all.end(), [&](const auto& o) { return o.name == part.option; });
    const auto number = part.option.empty() ? 0 : place - all.begin() + 1;
    const std::string name = part.option.empty() ? "as_it_is" : folder_name(part.option);
    part.folder =
        request.folder / fmt::format("{}_{}", number, name) / fmt::format("{}_{}", scenario, folder_name(of.name));
    part.definition = std::make_shared<nlohmann::ordered_json>(
        ensemble_definition(*part.runs, part.source, *part.scene, request.scene_name));
    return part;
}

/// A sum of maps that lie on the same raster of cells; it grows to hold all of them.
class MapSum {
  public:
    void add(const Grid<float>& map, double weight) {
        const GridGeometry& g = map.geometry;
        if (g.size() == 0) return;
        grow(g);
        const int right = cells(g.x_min - sum_.geometry.x_min), up = cells(g.y_min - sum_.geometry.y_min);
        for (int row = 0; row < g.rows; ++row) {
            for (int column = 0; column < g.columns; ++column) {
                const float value = map.at(column, row);
                if (value > 0) sum_.at(column + right, row + up) += weight * static_cast<double>(value);
            }
        }
    }
    [[nodiscard]] Grid<float> take() const {
        Grid<float> made(sum_.geometry, std::numeric_limits<float>::quiet_NaN());
        for (std::size_t i = 0; i < sum_.values.size(); ++i) {
            if (sum_.values[i] > 0) made.values[i] = static_cast<float>(sum_.values[i]);
        }
        return made;
    }

  private:
    [[nodiscard]] int cells(double distance) const {
        return static_cast<int>(std::lround(distance / sum_.geometry.cell));
    }
    void grow(const GridGeometry& more) {
        if (sum_.geometry.size() == 0) {
            sum_ = Grid<double>(more, 0);
            return;
        }
        const Extent a = sum_.geometry.extent(), b = more.extent();
        GridGeometry g = sum_.geometry;
        g.x_min = std::min(a.x_min, b.x_min);
        g.y_min = std::min(a.y_min, b.y_min);
        g.columns = cells(std::max(a.x_max, b.x_max) - g.x_min);
        g.rows = cells(std::max(a.y_max, b.y_max) - g.y_min);
        if (g == sum_.geometry) return;
        Grid<double> grown(g, 0);
        const int right = cells(a.x_min - g.x_min), up = cells(a.y_min - g.y_min);
        for (int row = 0; row < sum_.geometry.rows; ++row) {
            for (int column = 0; column < sum_.geometry.columns; ++column) {
                grown.at(column + right, row + up) = sum_.at(column, row);
            }
        }
        sum_ = std::move(grown);
    }
    Grid<double> sum_;
};

/// Peak depth, speed and pressure of a run.
Result<HazardMaps> read_maps(const fs::path& file, const ensemble::RunRecord& record) {
    constexpr std::array<std::size_t, 3> wanted = {0, 1, 2};
    HazardMaps maps;
    for (const std::size_t map : wanted) {
        Grid<float>& grid = maps.*ensemble::recorded_maps[map].grid;
        grid.geometry = record.geometry;
        TALUS_ASSIGN(grid.values, read_map_rows(file, record, map, 0, record.geometry.rows));
    }
    return maps;
}

/// Of each cell, the probability of death of somebody there.
Grid<float> deaths_on(const Curve& curve, const HazardMaps& maps) {
    Grid<float> made(maps.peak_depth.geometry, 0);
    const auto number = [](float value) { return std::isnan(value) ? 0.0 : static_cast<double>(value); };
    for (std::size_t i = 0; i < made.values.size(); ++i) {
        made.values[i] =
            static_cast<float>(curve.at({number(maps.peak_depth.values[i]), number(maps.peak_speed.values[i]),
                                         number(maps.peak_pressure.values[i])}));
    }
    return made;
}

Grid<float> deeper_than(double depth, const Grid<float>& peak_depth) {
    Grid<float> made(peak_depth.geometry, 0);
    for (std::size_t i = 0; i < made.values.size(); ++i) {
        made.values[i] = static_cast<double>(peak_depth.values[i]) > depth ? 1.0F : 0.0F;
    }
    return made;
}

/// Maps of a sum have the same cells. `first`: of the first map, which is taken where there is none yet.
Status check_cells(const Part& part, const ensemble::RunRecord& record, GridGeometry& first) {
    const GridGeometry& g = record.geometry;
    if (g.size() == 0) return {};
    if (first.size() == 0) first = g;
    const double east = (g.x_min - first.x_min) / first.cell, north = (g.y_min - first.y_min) / first.cell;
    const bool aligned = std::abs(east - std::round(east)) < 1e-3 && std::abs(north - std::round(north)) < 1e-3;
    if (aligned && std::abs(g.cell - first.cell) < 1e-9 * first.cell) return {};
    return Error{
        fmt::format("{}: run {} has maps of other cells than the runs before; no factor and no risk_scenario may "
                    "change the cells of the maps",
                    part.folder.string(), record.run)};
}

}  // namespace

std::size_t Study::run_count() const {
    std::size_t count = 0;
    for (const Part& part : parts) count += part.runs->count();
    return count;
}

double Study::frequency(std::size_t scenario) const {
    return per_event ? 1 : scenarios[scenario].frequency();
}

Result<Study> plan_study(const StudyRequest& request) {
    TALUS_ASSIGN(const scene::Scene base,
                 scene::load_scene(request.source.file, with(request.source, {}, "").overrides));
    TALUS_TRY(check_request(request, base));
    Study study;
    study.options = request.options;
    study.scenarios = base.spec.risk_scenarios;
    if (study.scenarios.empty()) {
        study.per_event = true;
        study.scenarios.emplace_back().name = "event";
    }
    TALUS_ASSIGN(study.exposures, find_exposures(base));
    for (std::size_t option = 0; option < study.options.size(); ++option) {
        for (std::size_t scenario = 0; scenario < study.scenarios.size(); ++scenario) {
            TALUS_ASSIGN(Part part, make_part(request, base, study, option, scenario));
            study.parts.push_back(std::move(part));
        }
    }
    return study;
}

Result<OptionOutcome> read_outcome(const Study& study, const std::string& option) {
    OptionOutcome made;
    made.option = option;
    MapSum debris, individual;
    GridGeometry cells;  // of the first map
    std::vector<ensemble::RunRecord> records;
    for (const Part& part : study.parts) {
        if (part.option != option) continue;
        const auto folder = ensemble::EnsembleFolder::join(part.folder, *part.definition);
        ScenarioOutcome& scenario = made.scenarios.emplace_back();
        scenario.name = study.scenarios[part.scenario].name;
        scenario.frequency = study.frequency(part.scenario);
        scenario.runs.resize(part.runs->count());
        std::vector<ensemble::RunRecord> own;
        for (std::size_t run = 0; run < part.runs->count(); ++run) {
            TALUS_ASSIGN(ensemble::RunRecord record,
                         ensemble::read_run_record(folder.run_file(run), folder.plan(), run));
            own.push_back(std::move(record));
        }
        const auto complete =
            std::count_if(own.begin(), own.end(), [](const auto& record) { return record.complete(); });
        if (complete < 2) {
            return Error{fmt::format("{}: {} of {} runs are complete; risk needs at least two{}", part.folder.string(),
                                     complete, own.size(), own.front().complete() ? "" : ": " + own.front().fault)};
        }
        const double weight = scenario.frequency / static_cast<double>(complete);
        for (const ensemble::RunRecord& record : own) TALUS_TRY(check_cells(part, record, cells));
        for (ensemble::RunRecord& record : own) {
            if (!record.complete()) {
                ++made.failed;
                continue;
            }
            TALUS_ASSIGN(const HazardMaps maps, read_maps(folder.run_file(record.run), record));
            scenario.runs[record.run] = outcome_of(study.exposures, record.buildings, maps);
            debris.add(deeper_than(part.scene->spec.outputs.arrival_depth, maps.peak_depth), weight);
            if (const Curve* curve = study.exposures.map_death) individual.add(deaths_on(*curve, maps), weight);
            records.push_back(std::move(record));
        }
    }
    made.debris = debris.take();
    if (study.exposures.map_death != nullptr) made.individual = individual.take();
    made.verdict = judge_together(records);
    for (ensemble::RunRecord& record : records) made.verdicts.push_back(std::move(record.verdict));
    return made;
}

}  // namespace talus::risk
