#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "core/try.hpp"
#include "sim/sources/seed.hpp"
#include "terrain/release.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/point_mass.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace rough_ground {

constexpr Quantity quantities[] = {
    {"apparent_friction", "1", true, Quantity::Site::none,
     "energy head z + u^2 / 2g lost per horizontal distance, averages over the mass; the law is that of point masses "
     "spread evenly over the block's length"},
};

struct Wave {
    double length = 0, height = 0;  // m, height from trough to crest
};

struct RoughSpec {
    std::vector<Wave> waves;
    std::vector<double> spacings, cells, thicknesses;  // m; a thickness of 0 is a lone particle
    double slope = 0, speed = 0, time = 0;             // rad, m/s, s
    double length = 0, width = 0;                      // m, of the block
};

struct Variant {
    Wave wave;
    double spacing = 0, cell = 0, thickness = 0;

    [[nodiscard]] std::string name() const {
        const std::string body = thickness > 0 ? fmt::format("{:g} m thick", thickness) : std::string("one particle");
        return fmt::format("waves {:g} x {:g} m, {}, spacing {:g} m, cells {:g} m", wave.length, wave.height, body,
                           spacing, cell);
    }
};

/// Means over the mass: what is left of the energy head, m, and the horizontal distance, m.
struct Means {
    double head = 0, way = 0;

    [[nodiscard]] double friction_since(const Means& start) const { return (start.head - head) / (way - start.way); }
};

Means means_of(const sim::State& state, double gravity) {
    Means m;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint v = state.velocity.at(i);
        m.head += (double{state.position.z[i]} + dot(v, v) / (2 * gravity)) / state.count;
        m.way += double{state.position.x[i]} / state.count;
    }
    return m;
}

/// The profile of the ground as the debris has it: between cell centres.
Profile profile_of(const terrain::Terrain& terrain) {
    return [&terrain](double x) {
        const auto slope_at = [&](double at) {
            const auto below = terrain.sample(at, 0.0);
            return -below.normal.x / below.normal.z;
        };
        constexpr double step = 1e-4;
        return ProfilePoint{terrain.sample(x, 0.0).height, slope_at(x),
                            (slope_at(x + step) - slope_at(x - step)) / (2 * step)};
    };
}

Means point_masses(const terrain::Terrain& terrain, double friction, double gravity, double speed,
                   const std::vector<double>& starts, double time, Means& start) {
    const Profile profile = profile_of(terrain);
    Means end;
    start = {};
    const auto share = 1 / static_cast<double>(starts.size());
    for (const double x : starts) {
        PointMass mass(profile, friction, gravity, x, speed);
        const auto add = [&](Means& m) {
            m.head += (mass.elevation() + mass.speed() * mass.speed() / (2 * gravity)) * share;
            m.way += mass.x() * share;
        };
        add(start);
        mass.advance_to(time);
        add(end);
    }
    return end;
}

Result<Measurement> compute_variant(const RoughSpec& spec, const Variant& variant, const Setting& setting,
                                    const Watch& watch, Outcome& outcome) {
    const double gravity = sim::Model{}.gravity;
    const double reach = spec.speed * spec.time + gravity * std::sin(spec.slope) * spec.time * spec.time / 2;
    const double length = reach + 2 * spec.length + 20;
    const Wave wave = variant.wave;
    const terrain::Terrain terrain = make_terrain(length, spec.width + 40, variant.cell, [&](double x, double) {
        return -std::tan(spec.slope) * x + wave.height / 2 * std::sin(2 * std::numbers::pi / wave.length * x);
    });
    const double first = -length / 2 + 10 + spec.length / 2;
    sim::Model model = sim::make_model(setting.material, setting.solver, variant.spacing);
    sim::Ground ground(terrain);
    sim::State start;
    if (variant.thickness > 0) {
        terrain::Release release;
        release.name = "block";
        const double a = first - spec.length / 2, b = first + spec.length / 2, half = spec.width / 2;
        release.patches.push_back({{{{a, -half}, {b, -half}, {b, half}, {a, half}}, {}}, variant.thickness});
        release.volume = release_volume(terrain, release);
        TALUS_ASSIGN(start, seed_releases(model, ground, {release}));
    } else {
        const auto below = terrain.sample(static_cast<float>(first), 0.0F);
        start = state_at_rest(
            {LocalPoint{static_cast<float>(first), 0, below.height} + below.normal * float(variant.spacing / 2)});
    }
    for (std::uint32_t i = 0; i < start.count; ++i) {
        const LocalPoint p = start.position.at(i), normal = terrain.sample(p.x, p.y).normal;
        start.velocity.set(i, LocalPoint{normal.z, 0, -normal.x} * float(spec.speed / std::hypot(normal.x, normal.z)));
    }
    const int masses = variant.thickness > 0 ? 80 : 1;
    std::vector<double> starts(static_cast<std::size_t>(masses));
    for (int k = 0; k < masses; ++k) {
        starts[static_cast<std::size_t>(k)] = first + spec.length * ((k + 0.5) / masses - 0.5);
    }
    const double friction = setting.material.friction_coefficient;
    Means law_start;
    const Means law_end = point_masses(terrain, friction, gravity, spec.speed, starts, spec.time, law_start);

    Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
    const Means before = means_of(trial.state(), gravity);
    const bool trusted = trial.advance_to(spec.time) && trial.state().outflow == 0;
    if (!trusted) outcome.notes.push_back(variant.name() + ": " + trial.problem());
    const Means after = means_of(trial.state(), gravity);
    return Measurement{"apparent_friction", variant.name(), trusted ? after.friction_since(before) : not_computed,
                       law_end.friction_since(law_start),
                       variant.spacing > *std::min_element(spec.spacings.begin(), spec.spacings.end())};
}

Result<Outcome> compute(const RoughSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    for (const double thickness : spec.thicknesses) {
        for (const Wave& wave : spec.waves) {
            for (const double cell : spec.cells) {
                for (const double spacing : spec.spacings) {
                    const Variant variant{wave, spacing, cell, thickness};
                    watch.say(variant.name());
                    TALUS_ASSIGN(Measurement measured, compute_variant(spec, variant, setting, watch, outcome));
                    outcome.measurements.push_back(std::move(measured));
                }
            }
        }
    }
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false}, not_negative{.low = 0};
    RoughSpec spec;
    for (const NumberPair& pair : parameters.pairs("waves_m", not_negative, true)) {
        spec.waves.push_back({pair[0], pair[1]});
    }
    spec.spacings = parameters.numbers("spacings_m", positive, {0.3});
    spec.cells = parameters.numbers("cells_m", positive, {1});
    spec.thicknesses = parameters.numbers("thicknesses_m", not_negative, {0.9});
    spec.slope = parameters.number("slope_deg", {.low = 1, .high = 70}, 30) * radians_per_degree;
    spec.speed = parameters.number("speed_mps", positive, 8);
    spec.length = parameters.number("block_length_m", positive, 40);
    spec.width = parameters.number("block_width_m", positive, 6);
    spec.time = parameters.number("time_s", positive, 6);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace rough_ground

Kind rough_ground_kind() {
    return {"rough_ground", "debris slides over waves of the ground, beside point masses", rough_ground::quantities,
            rough_ground::prepare};
}

}  // namespace talus::validate
