#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace free_fall {

constexpr Quantity quantities[] = {
    {"landing_distance", "m", true, Quantity::Site::none,
     "mean distance from the edge at which particles come down to two spacings above the ground"},
    {"parabola_deviation", "1", false, Quantity::Site::none,
     "distance of the falling mass from the parabola it set out on as it comes down, over the height of fall; "
     "particles "
     "may push each other apart on the way"},
    {"left_behind", "1", false, Quantity::Site::none, "share of the particles that still hang on the face at the end"},
};

struct FallSpec {
    double height = 0, speed = 0;           // m, m/s
    double spacing = 0, cell = 0;           // m, of the ground's raster
    int length = 0, layers = 0, width = 0;  // spacings
};

/// Data of a particle from the moment at which it is clear of the edge.
struct Flight {
    bool in_the_air = false, landed = false;
    double time = 0;
    LocalPoint start, velocity;
    LocalPoint deviation;  // from the parabola, m
    double landing = 0;    // distance from the edge, m
};

Result<Outcome> compute(const FallSpec& spec, const Setting& setting, const Watch& watch) {
    const double width = spec.width * spec.spacing, gravity = sim::Model{}.gravity;
    const double flight_time = std::sqrt(2 * spec.height / gravity);
    const double run = spec.speed * flight_time * 3 + spec.length * spec.spacing + 10;
    // The edge lies between the last cell centre above and the first below: a face as steep as the raster can make it.
    const terrain::Terrain terrain =
        make_terrain(2 * run, width + 4, spec.cell, [&](double x, double) { return x < 0 ? spec.height : 0; });
    params::MaterialSpec material = setting.material;
    material.building_friction_coefficient = 0;
    sim::Model model = sim::make_model(material, setting.solver, spec.spacing);
    sim::Ground ground(terrain, make_slice(terrain, width, spec.height), model.support_radius);
    const std::vector<LocalPoint> points =
        fill_block(-spec.cell, spec.height, spec.length, spec.width, spec.layers, spec.spacing);
    sim::State start = state_at_rest(points);
    for (std::uint32_t i = 0; i < start.count; ++i) start.velocity.x[i] = static_cast<float>(spec.speed);
    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
    const sim::State& state = trial.state();

    std::vector<Flight> flights(state.count);
    const double clear_of_the_edge = spec.cell, landing_height = 2 * spec.spacing;
    Series paths{"particles", Series::Style::marks, {}, {}};
    const auto follow = [&] {
        for (std::uint32_t i = 0; i < state.count; ++i) {
            Flight& flight = flights[state.id[i]];
            const LocalPoint p = state.position.at(i);
            if (flight.landed || p.x < clear_of_the_edge) continue;
            if (!flight.in_the_air) {
                flight = {true, false, state.time, p, state.velocity.at(i), {}, 0};
                continue;
            }
            const double t = state.time - flight.time;
            if (p.z < landing_height) {
                flight.landed = true;
                flight.landing = p.x;
                continue;
            }
            const LocalPoint fall{0, 0, static_cast<float>(-gravity * t * t / 2)};
            flight.deviation = p - (flight.start + flight.velocity * static_cast<float>(t) + fall);
        }
    };
    const double end = flight_time + (spec.length * spec.spacing + 2 * spec.cell) / spec.speed + 2;
    double next_mark = 0;
    const bool trusted = trial.advance_to(end, [&] {
        follow();
        if (state.time < next_mark) return;
        next_mark += end / 20;
        for (std::uint32_t i = 0; i < state.count; i += 29) {
            if (state.position.z[i] < landing_height) continue;
            paths.x.push_back(state.position.x[i]);
            paths.y.push_back(state.position.z[i]);
        }
    });

    Outcome outcome;
    double landing = not_computed, expected = 0, deviation = not_computed, behind = not_computed;
    // Every layer falls from its own height; on level ground without friction nothing changes the speed before the
    // edge.
    for (const LocalPoint& p : points) {
        expected += spec.speed * std::sqrt(2 * (p.z - landing_height) / gravity) / static_cast<double>(points.size());
    }
    if (trusted) {
        double distances = 0;
        LocalPoint deviations{};
        int landed = 0;
        for (const Flight& flight : flights) {
            if (!flight.landed) continue;
            distances += flight.landing;
            deviations += flight.deviation;
            ++landed;
        }
        landing = distances / landed;
        deviation = length(deviations) / landed / spec.height;
        behind = 1 - static_cast<double>(landed) / static_cast<double>(flights.size());
    } else {
        outcome.notes.push_back(trial.problem());
    }
    outcome.measurements = {{"landing_distance", "", landing, expected},
                            {"parabola_deviation", "", deviation, {}},
                            {"left_behind", "", behind, {}}};
    Series parabola{"parabola", Series::Style::dashed, {}, {}};
    for (int k = 0; k <= 100; ++k) {
        const double t = flight_time * k / 100;
        parabola.x.push_back(spec.speed * t);
        parabola.y.push_back(spec.height + spec.layers * spec.spacing / 2 - gravity * t * t / 2);
    }
    outcome.charts.push_back({"fall",
                              "Particles over a step, every twentieth of the run",
                              "distance from the edge, m",
                              "elevation, m",
                              {parabola, paths}});
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    FallSpec spec;
    spec.height = parameters.number("height_m", positive, 10);
    spec.speed = parameters.number("speed_mps", positive, 8);
    spec.spacing = parameters.number("particle_spacing_m", positive, 0.3);
    spec.cell = parameters.number("ground_cell_m", positive, 1);
    spec.length = parameters.whole_number("length_spacings", {.low = 1, .high = 1000}, 12);
    spec.layers = parameters.whole_number("layers", {.low = 1, .high = 100}, 3);
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 6);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace free_fall

Kind free_fall_kind() {
    return {"free_fall", "debris in free fall over a step", free_fall::quantities, free_fall::prepare};
}

}  // namespace talus::validate
