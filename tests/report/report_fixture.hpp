#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "report/report.hpp"
#include "report/results.hpp"
#include "run/comparison.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// A made-up valley with a made-up debris flow in it: everything a report shows, without a simulation.
namespace talus::test {

struct SampleValley {
    static constexpr double east = 824100, north = 825500, width = 300, height = 200, cell = 2;
    static constexpr double toe = 262;  ///< m, where the front stops

    static std::vector<PlanPoint> path() {
        std::vector<PlanPoint> points;
        for (const auto& [x, y] : {std::pair{24.0, 172.0},
                                   {60.0, 160.0},
                                   {105.0, 148.0},
                                   {128.0, 132.0},
                                   {138.0, 108.0},
                                   {150.0, 84.0},
                                   {185.0, 62.0},
                                   {222.0, 50.0},
                                   {262.0, 34.0},
                                   {299.0, 19.0}}) {
            points.push_back({east + x, north + y});
        }
        return points;
    }

    /// Elevation of the valley floor: steep, then gentle, with a fall of 10 m at chainage 165.
    static double floor_at(double c) {
        double z = 152 - 0.62 * std::min(c, 95.0);
        z -= 0.30 * std::clamp(c - 95, 0.0, 1000.0);
        z -= 10 / (1 + std::exp(-(c - 165) / 1.2));
        return z + 0.5 * std::sin(c / 6.5);
    }

    /// Velocity of the front, m/s.
    static double velocity_at(double c) {
        const double v = c < 110 ? 2 + 10.2 * std::sqrt(std::min(c, 110.0) / 110) : 12.2 - 9.5 * (c - 110) / 150;
        return std::max(0.8, v + 0.5 * std::sin(c / 9));
    }

    /// Ground: the floor and the sides of the valley, those of near parts of the path weighing most.
    static double ground_at(const std::vector<PlanPoint>& path, const PlanPoint& p) {
        double sum = 0, weights = 0, chainage = 0;
        for (std::size_t i = 0; i + 1 < path.size(); ++i) {
            const double dx = path[i + 1].x - path[i].x, dy = path[i + 1].y - path[i].y, length = std::hypot(dx, dy);
            for (double t = 1; t < length; t += 2) {
                const double c = chainage + t;
                const double d = std::hypot(p.x - path[i].x - t * dx / length, p.y - path[i].y - t * dy / length);
                const double side = (c > 190 ? 22 : 40) * (1 - std::exp(-d * d / (d + 14) / 48));
                const double weight = 1 / std::pow(d * d + 9, 2);
                sum += weight * (floor_at(c) + side);
                weights += weight;
            }
            chainage += length;
        }
        double rough = 0;
        for (const auto& [size, height] : {std::pair{31.0, 1.3}, {14.0, 0.6}, {6.5, 0.25}}) {
            rough += height * std::sin(p.x / size + 1.7 * std::sin(p.y / (1.3 * size))) * std::cos(p.y / size - 0.6);
        }
        return sum / weights + rough;
    }

    static double half_width_at(double c) {
        return c < 40 ? 11 : c < 175 ? 6.5 + 1.5 * std::sin(c / 13) : 6.5 + 0.22 * (c - 175);
    }
};

struct NearestOnPath {
    double chainage, offset;  ///< offset positive to the left; chainage runs on beyond both ends
};

inline NearestOnPath nearest_on_path(const std::vector<PlanPoint>& path, double x, double y) {
    NearestOnPath best{0, 1e9};
    double start = 0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        const double dx = path[i + 1].x - path[i].x, dy = path[i + 1].y - path[i].y, length = std::hypot(dx, dy);
        double t = ((x - path[i].x) * dx + (y - path[i].y) * dy) / length;
        if (i > 0) t = std::max(t, 0.0);
        if (i + 2 < path.size()) t = std::min(t, length);
        const double px = path[i].x + t * dx / length, py = path[i].y + t * dy / length;
        const double side = dx * (y - py) - dy * (x - px) > 0 ? 1 : -1;
        const double offset = side * std::hypot(x - px, y - py);
        if (std::abs(offset) < std::abs(best.offset)) best = {start + t, offset};
        start += length;
    }
    return best;
}

inline Polygon rectangle(double x, double y, double width, double height, double turn) {
    Polygon p;
    for (const auto& [u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
        const double a = u * width, b = v * height;
        p.outer.push_back({SampleValley::east + x + a * std::cos(turn) - b * std::sin(turn),
                           SampleValley::north + y + a * std::sin(turn) + b * std::cos(turn)});
    }
    return p;
}

inline scene::Scene sample_scene() {
    using V = SampleValley;
    scene::Scene scene;
    scene.file = "scenes/sample_valley/scene.toml";
    const auto path = V::path();
    Grid<float> elevation(GridGeometry{V::east, V::north, V::cell, static_cast<int>(V::width / V::cell),
                                       static_cast<int>(V::height / V::cell)});
    for (int r = 0; r < elevation.geometry.rows; ++r) {
        for (int c = 0; c < elevation.geometry.columns; ++c) {
            const PlanPoint p = elevation.geometry.centre(c, r);
            elevation.at(c, r) = static_cast<float>(V::ground_at(path, p));
        }
    }
    // A corner without data, as at the edge of a survey.
    for (int r = 0; r < 9; ++r) {
        for (int c = 0; c < 16 - r; ++c) elevation.at(c, r) = std::numeric_limits<float>::quiet_NaN();
    }
    scene.terrain = terrain::Terrain(elevation);
    scene.crs.name = "Hong Kong 1980 Grid System";
    scene.crs.epsg = 2326;
    scene.vertical_unit = "m";
    scene.nodata_share = 0.007;

    params::SceneInfo& info = scene.spec.scene;
    info.title = "Sample valley: debris flow above five houses";
    info.description =
        "A made-up valley with a bend and a waterfall, in which 600 m³ of debris run down to a hamlet. "
        "It exists to show and to test the report; nothing here was simulated.";
    info.reconstruction = true;
    info.assumptions = {"The valley is drawn by formulae; its floor falls by 10 m at chainage 165 m.",
                        "The release is 1.4 m thick everywhere.",
                        "Footprints and heights of three houses are assumed."};
    info.sources = {"Front velocities at 121 m and 217 m after GEO Report 169.", "No other data."};
    scene.spec.terrain.file = "terrain.tif";
    scene.spec.solver.particle_spacing = 0.42;
    scene.spec.observations = {{"Superelevation at the bend", 121, 11, {}, "GEO Report 169, superelevation marks"},
                               {"Superelevation above the houses", 217, 7, {}, "GEO Report 169, superelevation marks"}};

    params::ReleaseSpec release_spec;
    release_spec.name = "head scarp";
    release_spec.file = "release.geojson";
    release_spec.volume = 600;
    scene.spec.releases = {release_spec};
    terrain::Release release;
    release.name = "head scarp";
    release.patches.push_back({rectangle(38, 167, 30, 17, -0.3), 1.4});
    release.volume = 600;
    scene.releases.push_back(release);

    scene.flow_path = terrain::FlowPath(path, 60);
    const auto building = [&](const char* name, Polygon footprint, double height, bool assumed) {
        terrain::Building b;
        b.name = name;
        b.footprint = {std::move(footprint)};
        b.height = height;
        b.height_assumed = assumed;
        scene.buildings.push_back(b);
    };
    building("House 38", rectangle(236, 45, 12, 9, -0.35), 6, false);
    building("House 21A", rectangle(228, 62, 10, 8, -0.3), 6, true);
    building("House 12", rectangle(214, 38, 9, 8, -0.3), 7.5, false);
    building("Temple", rectangle(262, 62, 16, 12, 0.1), 8, true);
    building("Store", rectangle(268, 18, 9, 6, 0.2), 4, true);

    scene.inputs = {{"terrain", "scenes/sample_valley/terrain.tif", 61234, "9f1c22ab74d10e55"},
                    {"release head scarp", "scenes/sample_valley/release.geojson", 812, "03bb917c5d2f4e6a"},
                    {"buildings", "scenes/sample_valley/buildings.gpkg", 98304, "77f0a1b2c3d4e5f6"}};
    scene.notes = {"buildings: reprojected from EPSG:4326 (WGS 84) to EPSG:2326 (Hong Kong 1980 Grid System)",
                   "3 of 5 buildings have no height; the default of 6 m is assumed"};
    return scene;
}

inline run::RunResult sample_result(const scene::Scene& scene) {
    using V = SampleValley;
    run::RunResult result;
    result.stop_reason = "debris came to rest (less than 0.1 % of it moving for 3 s)";
    observe::Observation& o = result.observation;
    const auto path = V::path();
    constexpr double map_cell = 1;
    const float none = std::numeric_limits<float>::quiet_NaN();

    // Arrival times by integrating the front velocity.
    std::vector<double> arrival = {0};
    for (int c = 1; c <= static_cast<int>(V::toe); ++c) arrival.push_back(arrival.back() + 1 / V::velocity_at(c - 0.5));
    for (int c = 20; c <= static_cast<int>(V::toe); ++c) {
        const double front = V::velocity_at(c), particle = 0.93 * V::velocity_at(c - 2) + 0.3 * std::sin(c / 4.0);
        o.front.push_back({double(c), arrival[static_cast<std::size_t>(c)], c < 25 ? observe::never : front,
                           std::max(0.2, particle)});
    }

    const Grid<float> blank(GridGeometry{V::east + 8, V::north + 8, map_cell, 270, 188}, none);
    o.maps = {blank, blank, blank, blank, blank};
    for (int r = 0; r < blank.geometry.rows; ++r) {
        for (int c = 0; c < blank.geometry.columns; ++c) {
            const PlanPoint p = blank.geometry.centre(c, r);
            const NearestOnPath on = nearest_on_path(path, p.x, p.y);
            if (on.chainage < 2 || on.chainage > V::toe) continue;
            const double ragged =
                1 + 0.16 * std::sin(on.chainage / 3.1) + 0.1 * std::sin(on.chainage / 1.3 + on.offset);
            const double across = std::abs(on.offset) / (V::half_width_at(on.chainage) * ragged);
            if (across >= 1) continue;
            const double shape = 1 - across * across;
            const double depth = (on.chainage < 40 ? 1.7
                                                   : 2.6 - 0.006 * on.chainage +
                                                         0.9 * std::exp(-std::pow((on.chainage - 128) / 12, 2))) *
                                 shape;
            const double speed = V::velocity_at(on.chainage) * (0.55 + 0.6 * shape);
            const double deposit = on.chainage < 130 ? 0.18 * shape : shape * (0.2 + 1.5 * (on.chainage - 130) / 100);
            const auto i = blank.geometry.index(c, r);
            o.maps.peak_depth.values[i] = static_cast<float>(depth);
            o.maps.peak_speed.values[i] = static_cast<float>(speed);
            o.maps.peak_pressure.values[i] = static_cast<float>(2000 * speed * speed);
            o.maps.arrival_time.values[i] =
                static_cast<float>(arrival[static_cast<std::size_t>(on.chainage)] + 0.8 * across);
            o.maps.deposit_depth.values[i] = static_cast<float>(deposit);
        }
    }
    o.run_out.front_chainage = V::toe;
    o.run_out.along_flow = V::toe - 3;
    o.run_out.straight = V::toe - 20;
    o.run_out.crown = scene.flow_path.point_at(3);
    o.run_out.toe = scene.flow_path.point_at(V::toe);
    o.run_out.drop = V::floor_at(3) - V::floor_at(V::toe);
    o.run_out.runout_angle = std::atan(o.run_out.drop / o.run_out.along_flow);
    o.run_out.travel_angle = o.run_out.runout_angle + 0.02;

    for (const terrain::Building& b : scene.buildings) {
        observe::BuildingImpact impact;
        impact.name = b.name;
        o.buildings.push_back(impact);
    }
    o.buildings[0] = {"House 38", true, arrival[226], 412e3, 38.4e3, 1.62, 61e3};
    o.buildings[1] = {"House 21A", true, arrival[228] + 1.3, 61e3, 9.7e3, 0.55, 12e3};
    o.buildings[2] = {"House 12", true, arrival[215] + 0.8, 143e3, 21.5e3, 0.94, 33e3};

    o.volume_released = 600;
    const double stop = arrival.back(), end = stop + 9;
    for (double t = 0; t <= end; t += 0.1) {
        observe::TimeSample s;
        s.time = t;
        const double share = std::min(1.0, t / stop);
        const auto c = static_cast<double>(std::upper_bound(arrival.begin(), arrival.end(), t) - arrival.begin() - 1);
        s.front_chainage = c;
        s.volume_released = 600;
        s.volume_left = 0;
        s.volume_deposited =
            std::clamp(0.5 * 600 * (1 + 1.06 * std::tanh((t - stop + 4) / 5)), 0.0, 600.0) * (t > 2 ? 1 : 0);
        s.volume_moving = 600 - s.volume_deposited;
        s.kinetic_energy = 600 * 2000 * 0.5 * std::pow(0.75 * V::velocity_at(c), 2) * (1 - s.volume_deposited / 600) *
                           std::min(1.0, t / 2);
        s.potential_energy = 600 * 2000 * 9.81 * (40 + 88 * std::pow(1 - 0.75 * share, 1.6));
        s.largest_speed = t > end - 3 ? 0.1 : 1.3 * V::velocity_at(c) * std::min(1.0, t / 1.5);
        s.mean_compression = 0.002 + 0.004 * std::exp(-std::pow((t - 13) / 4, 2)) + 0.0006 * std::sin(t * 3);
        s.max_compression = 0.012 + 0.011 * std::exp(-std::pow((t - 14) / 5, 2)) + 0.002 * std::sin(t * 7);
        s.time_step = 0.008;
        s.steps_per_second = 210;
        o.timeseries.push_back(s);
    }
    o.compression.worst_mean = 0.0066;
    o.compression.worst_max = 0.0249;
    o.compression.worst_mean_time = 13;
    o.compression.worst_max_time = 14;

    for (std::size_t k = 0; k < result.stage_times.seconds.size(); ++k)
        result.stage_times.seconds[k] = 0.4 + 1.7 * static_cast<double>(k * k % 7);
    result.hash = 0x8c1f00d2a4b39e57ULL;
    result.particles = 8099;
    result.steps = 6120;
    result.simulated_time = end;
    result.wall_time = 30.7;
    result.smallest_time_step = 0.0042;
    result.largest_time_step = 1.0 / 60;
    result.particle_spacing = 0.42;
    result.support_radius = 0.924;
    result.map_cell = map_cell;
    result.kinematic_viscosity = 0.31;
    result.thread_count = 2;
    return result;
}

/// Made-up variants of the sample: `pace` times as fast as it everywhere.
inline run::VariantRun sample_variant(const run::RunResult& base, const std::string& name,
                                      const std::string& override_text, double pace) {
    run::VariantRun run{{.name = name, .overrides = {override_text}}, base, ""};
    observe::Observation& o = run.result->observation;
    run.peaks = observe::measure_peaks(o.maps);
    run.peaks.speed.value *= pace;
    run.peaks.pressure.value *= pace * pace;
    o.maps = {};
    o.timeseries = {};
    for (observe::FrontSample& f : o.front) {
        f.front_velocity *= pace;
        f.arrival_time /= pace;
    }
    for (observe::BuildingImpact& b : o.buildings) b.first_hit_time /= pace;
    run.result->wall_time *= 2;
    return run;
}

/// Refinements of which one fails and one is missing, and a sensitivity to more inputs than there are colours.
inline std::vector<run::Comparison> sample_comparisons(const scene::Scene& scene, const run::RunResult& result) {
    std::vector<run::VariantRun> refined = {
        sample_variant(result, "half the time step", "solver.displacement_limit=0.25", 1.02),
        sample_variant(result, "double the iterations", "solver.iteration_count=8", 0.93),
        {{.name = "three times the particles", .overrides = {"solver.particle_spacing_m=0.29"}},
         std::nullopt,
         "interrupted at t = 12.3 s"}};
    std::vector<run::VariantRun> varied;
    for (int i = 0; i < 10; ++i) {
        const double friction = 0.3 + 0.02 * i;
        const std::string value = std::to_string(friction).substr(0, 4);
        varied.push_back(sample_variant(result, "material.friction_coefficient = " + value,
                                        "material.friction_coefficient=" + value, 1.8 - 2 * friction));
    }
    return {compare(run::ComparisonKind::convergence, scene, result, refined),
            compare(run::ComparisonKind::sensitivity, scene, result, varied)};
}

/// The report's page; empty where it could not be made.
inline std::string report_page(const scene::Scene& scene, const run::RunResult& result,
                               const std::vector<run::Comparison>& comparisons = {}) {
    const auto page = report::run_report(scene, result, report::run_results(scene, result, comparisons));
    return page ? *page : "";
}

struct Sample {
    scene::Scene scene = sample_scene();
    run::RunResult result = sample_result(scene);

    [[nodiscard]] std::string html() const { return report_page(scene, result); }
};

/// Unlike a matcher, it does not print the page when it fails.
inline bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace talus::test
