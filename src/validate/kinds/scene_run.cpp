#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "core/try.hpp"
#include "report/results.hpp"
#include "run/run_scene.hpp"
#include "scene/scene.hpp"
#include "sim/backend_choice.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/suite.hpp"

namespace talus::validate {
namespace scene_run {

constexpr Quantity quantities[] = {
    {"front_velocity", "m/s", false, Quantity::Site::chainage, "slope of chainage against the front's arrival time"},
    {"particle_speed", "m/s", false, Quantity::Site::chainage, "mean speed of the debris at the front on arrival"},
    {"arrival_time", "s", false, Quantity::Site::chainage, "when the front came"},
    {"run_out", "m", false, Quantity::Site::none, "along the flow from the crown to the farthest deposit"},
    {"front_chainage", "m", false, Quantity::Site::none, "farthest chainage that the front reached"},
    {"runout_angle", "deg", false, Quantity::Site::none, "from crown to toe"},
    {"travel_angle", "deg", false, Quantity::Site::none, "between the centres of mass of release and deposit"},
    {"building_hit", "1", false, Quantity::Site::building, "1 if debris struck the building, else 0"},
    {"first_hit_time", "s", false, Quantity::Site::building, "when debris first struck the building"},
    {"peak_impact_pressure", "kPa", false, Quantity::Site::building,
     "filtered force on a patch of the wall over its area"},
    {"peak_depth", "m", false, Quantity::Site::place, "greatest flow depth near a place"},
    {"height_reached", "m", false, Quantity::Site::place,
     "highest ground that debris reached near a place, above the flow path beside it: the height of marks on a bank"},
    {"mean_compression", "1", false, Quantity::Site::none, "worst mean compression of the run"},
    {"max_compression", "1", false, Quantity::Site::none, "worst compression of any particle"},
};

/// Debris on the map's cells within the radius of a place.
struct Surroundings {
    double peak_depth = 0, height_reached = 0;  // m
};

Surroundings look_around(const Expectation& e, const scene::Scene& scene, const observe::Observation& observation) {
    Surroundings found;
    const Grid<float>& depth = observation.maps.peak_depth;
    for (int row = 0; row < depth.geometry.rows; ++row) {
        for (int column = 0; column < depth.geometry.columns; ++column) {
            const PlanPoint p = depth.geometry.centre(column, row);
            const double here = depth.at(column, row);
            if (std::hypot(p.x - *e.x, p.y - *e.y) > *e.radius || !(here > scene.spec.outputs.arrival_depth)) continue;
            found.peak_depth = std::max(found.peak_depth, here);
            const auto beside = scene.flow_path.locate(p);
            if (!beside) continue;
            const double bed = scene.terrain.elevation_at(scene.flow_path.point_at(beside->chainage));
            found.height_reached = std::max(found.height_reached, scene.terrain.elevation_at(p) - bed);
        }
    }
    return found;
}

double measure_building(const Expectation& e, const observe::Observation& observation) {
    for (const observe::BuildingImpact& building : observation.buildings) {
        if (building.name != e.building) continue;
        if (e.quantity == "building_hit") return building.hit ? 1 : 0;
        if (e.quantity == "first_hit_time") return building.first_hit_time;
        return building.peak_impact_pressure / 1000;
    }
    return not_computed;
}

double measure(const Expectation& e, const scene::Scene& scene, const observe::Observation& observation) {
    if (e.chainage) {
        const observe::FrontSample front = front_at(observation, *e.chainage);
        return e.quantity == "front_velocity"   ? front.front_velocity
               : e.quantity == "particle_speed" ? front.particle_speed
                                                : front.arrival_time;
    }
    if (!e.building.empty()) return measure_building(e, observation);
    if (e.x) {
        const Surroundings found = look_around(e, scene, observation);
        return e.quantity == "peak_depth" ? found.peak_depth : found.height_reached;
    }
    if (e.quantity == "run_out") return observation.run_out.along_flow;
    if (e.quantity == "front_chainage") return observation.run_out.front_chainage;
    if (e.quantity == "runout_angle") return observation.run_out.runout_angle * degrees_per_radian;
    if (e.quantity == "travel_angle") return observation.run_out.travel_angle * degrees_per_radian;
    return e.quantity == "mean_compression" ? observation.compression.worst_mean : observation.compression.worst_max;
}

constexpr const char* grid_model = "depth-averaged";  // `where` of expectations of that model

/// `variant`: of the scene; empty: the scene as given.
Result<Outcome> compute(const std::filesystem::path& file, const std::string& variant, const Setting& setting,
                        const Watch& watch) {
    std::vector<std::string> overrides;
    if (!variant.empty()) overrides.push_back("variant=" + variant);
    overrides.insert(overrides.end(), setting.overrides.begin(), setting.overrides.end());
    if (watch.thread_count > 0) overrides.push_back(fmt::format("solver.thread_count={}", watch.thread_count));
    if (watch.backend != params::BackendChoice::cpu) {
        overrides.push_back(fmt::format("solver.backend={}", sim::backend_name(watch.backend)));
    }
    TALUS_ASSIGN(const scene::Scene scene, scene::load_scene(file, overrides));
    run::RunOptions options;
    options.stop_requested = watch.stop_requested;
    options.on_progress = [&](const run::Progress& progress) {
        if (progress.step % 50 == 0) watch.say(fmt::format("t {:.1f} s", progress.time));
    };
    TALUS_ASSIGN(const run::RunResult run, run_scene(scene, options));
    const observe::Observation& observation = run.observation;

    Outcome outcome;
    outcome.notes.push_back(fmt::format("{} particles of {:.3g} m, {:.1f} s: {}", run.particles, run.particle_spacing,
                                        run.simulated_time, run.stop_reason));
    Series front{"computed", Series::Style::line, {}, {}}, observed{"observed", Series::Style::marks, {}, {}};
    for (const observe::FrontSample& sample : observation.front) {
        front.x.push_back(sample.chainage);
        front.y.push_back(sample.front_velocity);
    }
    const bool trusted = run.status != run::RunStatus::fault;
    for (const Expectation& e : setting.expectations) {
        if (e.where == grid_model) continue;
        outcome.measurements.push_back(
            {e.quantity, place_text(e), trusted ? measure(e, scene, observation) : not_computed, {}});
        if (e.quantity != "front_velocity") continue;
        observed.x.push_back(*e.chainage);
        observed.y.push_back(*e.expected);
    }
    std::vector<Series> curves{front, observed};
    if (std::any_of(setting.expectations.begin(), setting.expectations.end(),
                    [](const Expectation& e) { return e.where == grid_model; })) {
        overrides.emplace_back("solver.model=depth_averaged");
        TALUS_ASSIGN(const scene::Scene grid_scene, scene::load_scene(file, overrides));
        TALUS_ASSIGN(const run::RunResult grid, run_scene(grid_scene, options));
        for (const Expectation& e : setting.expectations) {
            if (e.where != grid_model) continue;
            outcome.measurements.push_back({e.quantity, place_text(e), measure(e, grid_scene, grid.observation), {}});
        }
        Series by_grid{grid_model, Series::Style::dashed, {}, {}};
        for (const observe::FrontSample& sample : grid.observation.front) {
            by_grid.x.push_back(sample.chainage);
            by_grid.y.push_back(sample.front_velocity);
        }
        curves.push_back(std::move(by_grid));
    }
    outcome.charts.push_back(
        {"front", "Front velocity along the flow path", "chainage, m", "front velocity, m/s", std::move(curves)});
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    const std::filesystem::path file = parameters.path("scene");
    const std::string variant = parameters.text("variant", "");
    return [file, variant, setting](const Watch& watch) { return compute(file, variant, setting, watch); };
}

}  // namespace scene_run

Kind scene_kind() {
    return {"scene", "a scene file is run, and quantities of the run are compared", scene_run::quantities,
            scene_run::prepare};
}

}  // namespace talus::validate
