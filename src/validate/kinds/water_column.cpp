#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/measure.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace water_column {

constexpr Quantity quantities[] = {
    {"front", "1", true, Quantity::Site::none,
     "distance of the front, where half a layer of particles still covers the bed, from the column's back over its "
     "base; "
     "measured values of the case file"},
};

struct ColumnSpec {
    double base = 0, height_ratio = 0;  // m, 1
    std::vector<double> resolutions;    // spacings per base
    int width = 0;                      // spacings
    std::vector<NumberPair> measured;   // t sqrt(2 g / base), front / base
};

Result<Outcome> compute(const ColumnSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    Chart fronts{"front",
                 "Front of a collapsing water column",
                 "t sqrt(2 g / a)",
                 "front / a",
                 {{"measured", Series::Style::marks, {}, {}}}};
    for (const NumberPair& p : spec.measured) {
        fronts.series[0].x.push_back(p[0]);
        fronts.series[0].y.push_back(p[1]);
    }
    const double furthest = spec.measured.back()[1] * spec.base * 1.6;
    const double finest = *std::max_element(spec.resolutions.begin(), spec.resolutions.end());
    for (const double resolution : spec.resolutions) {
        const double spacing = spec.base / resolution, width = spec.width * spacing,
                     height = spec.height_ratio * spec.base;
        const std::string by_resolution = fmt::format("{:g} spacings", resolution);
        watch.say(by_resolution);
        const Incline flat(0, 2 * furthest, width + 4);
        std::vector<terrain::Building> walls = make_slice(flat.terrain(), width, 2 * height);
        const Extent extent = flat.terrain().elevation().geometry.extent();
        walls.push_back(make_wall(flat.terrain(), extent.x_min, extent.y_min, 0, extent.y_max, 2 * height));
        sim::Model model = sim::make_model(setting.material, setting.solver, spacing);
        sim::Ground ground(flat.terrain(), walls, model.support_radius);
        const auto depth = [&](double, double) { return height; };
        const auto points =
            fill_lattice(flat, spacing, 0, static_cast<int>(std::lround(resolution)), -width / 2, spec.width, depth);
        sim::State start = state_under_weight(model, ground, points, flat, depth);
        Trial trial({std::move(model), std::move(ground), std::move(start)}, watch);
        const sim::State& state = trial.state();
        // Where the water still covers the bed; drops ahead of it are not the front.
        const auto front = [&] {
            const int cells = static_cast<int>(2 * furthest / spacing);
            const auto profile = thickness_profile(trial.model(), state, 0, spacing, cells, width,
                                                   [&](std::uint32_t i) { return double{state.position.x[i]}; });
            return edge_of(profile, spacing, spacing / 2) / spec.base;
        };
        const double unit_time = std::sqrt(spec.base / (2 * trial.model().gravity));
        Series computed{by_resolution, Series::Style::line, {0}, {front()}};
        for (const NumberPair& p : spec.measured) {
            double before_time = state.time / unit_time, before = front();
            // Steps do not end at the measured times: interpolated between the two around one.
            trial.advance_to(p[0] * unit_time, [&] {
                if (state.time / unit_time >= p[0]) return;
                before_time = state.time / unit_time;
                before = front();
                computed.x.push_back(before_time);
                computed.y.push_back(before);
            });
            const double after_time = state.time / unit_time, after = front();
            const double share = after_time > before_time ? (p[0] - before_time) / (after_time - before_time) : 1;
            const double value = trial.problem().empty() ? before + share * (after - before) : not_computed;
            outcome.measurements.push_back({"front", fmt::format("t sqrt(2 g / a) = {:g}, {}", p[0], by_resolution),
                                            value, p[1], resolution < finest});
        }
        if (!trial.problem().empty()) outcome.notes.push_back(by_resolution + ": " + trial.problem());
        fronts.series.push_back(computed);
    }
    outcome.charts.push_back(fronts);
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    constexpr params::Range positive{.low = 0, .low_included = false};
    ColumnSpec spec;
    spec.base = parameters.number("base_m", positive, 0.05715);
    spec.height_ratio = parameters.number("height_ratio", positive, 2);
    spec.resolutions = parameters.numbers("spacings_per_base", {.low = 2, .high = 1000}, {20});
    spec.width = parameters.whole_number("width_spacings", {.low = 2, .high = 1000}, 6);
    spec.measured = parameters.pairs("measured", positive, true);
    std::sort(spec.measured.begin(), spec.measured.end());
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace water_column

Kind water_column_kind() {
    return {"water_column", "a column of water that collapses on a smooth bed", water_column::quantities,
            water_column::prepare};
}

}  // namespace talus::validate
