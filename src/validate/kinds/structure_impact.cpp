#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/sources/seed.hpp"
#include "validate/kinds/kinds.hpp"
#include "validate/set_up.hpp"

namespace talus::validate {
namespace structure_impact {

constexpr Quantity quantities[] = {
    {"force", "N", true, Quantity::Site::none, "greatest filtered force on a structure, against the finest spacing"},
    {"pressure", "Pa", true, Quantity::Site::none, "greatest impact pressure on a patch of it, against the same"},
};

struct ImpactSpec {
    std::vector<double> counts;
    double slope = 0, end = 0;  // rad, s
};

/// A block rotated by `turn` about its centre (x, y), world.
terrain::Building make_block(const terrain::Terrain& terrain, const char* name, const PlanPoint& middle, double length,
                             double width, double turn, double height) {
    const double c = std::cos(turn), s = std::sin(turn);
    Ring ring;
    for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        const double along = u * length / 2, across = v * width / 2;
        ring.push_back({middle.x + along * c - across * s, middle.y + along * s + across * c});
    }
    std::vector<terrain::Building> one(1);
    one[0].name = name;
    one[0].footprint = {{std::move(ring), {}}};
    one[0].height = height;
    place_buildings(terrain, one);
    return std::move(one[0]);
}

/// Debris of 34 x 10 x 3 m comes down a channel with banks of 45 degrees onto a house and three walls.
Result<std::vector<observe::BuildingImpact>> measure(const ImpactSpec& spec, double count, const Setting& setting,
                                                     const Watch& watch) {
    constexpr double length = 34, width = 10, thickness = 3, head = -8;  // m
    const terrain::Terrain terrain = make_terrain(
        160, 40, 1, [&](double x, double y) { return -std::tan(spec.slope) * x + std::max(0.0, std::abs(y) - 6); });
    const std::vector<terrain::Building> structures = {
        make_block(terrain, "house", {12, 0}, 4, 4, 0, 8), make_block(terrain, "wall to the left", {6, 6}, 1, 5, 0, 5),
        make_block(terrain, "oblique wall", {14, -6}, 1, 5, -M_PI / 4, 5),
        make_block(terrain, "wall across", {30, 0}, 1.5, 14, 0, 8)};
    // The number of particles that fit on a lattice, whose cells have the volume of a particle.
    const double wanted = std::cbrt(length * width * thickness / count);
    const std::array<double, 3> size = {length, width, thickness};
    std::array<int, 3> cells{};
    double spacing = length * width * thickness;
    for (std::size_t k = 0; k < 3; ++k) {
        cells[k] = static_cast<int>(std::lround(size[k] / wanted));
        spacing /= cells[k];
    }
    const Incline incline(spec.slope, 2, 2);
    const LocalPoint floor{0, 0, terrain.sample(0.0F, 0.0F).height}, middle = incline.point(0, 0, 0);
    std::vector<LocalPoint> points;
    for (int k = 0; k < cells[2]; ++k) {
        for (int j = 0; j < cells[1]; ++j) {
            for (int i = 0; i < cells[0]; ++i) {
                points.push_back(floor +
                                 incline.point(head - length + (i + 0.5) * length / cells[0],
                                               -width / 2 + (j + 0.5) * width / cells[1],
                                               (k + 0.5) * thickness / cells[2]) -
                                 middle);
            }
        }
    }
    sim::Model model = sim::make_model(setting.material, setting.solver, std::cbrt(spacing));
    sim::Ground ground(terrain, structures, model.support_radius);
    Trial trial({std::move(model), std::move(ground), state_at_rest(points), {}, {}, {}}, watch, OnFault::stop,
                Observed::yes);
    if (!trial.advance_to(spec.end)) return Error{trial.problem()};
    return trial.observer().impacts();
}

Result<Outcome> compute(const ImpactSpec& spec, const Setting& setting, const Watch& watch) {
    Outcome outcome;
    std::vector<std::vector<observe::BuildingImpact>> runs;
    for (const double count : spec.counts) {
        watch.say(fmt::format("{:g} particles", count));
        Result<std::vector<observe::BuildingImpact>> run = measure(spec, count, setting, watch);
        if (!run) return Error{run.error()};
        runs.push_back(std::move(*run));
    }
    Chart pressures{"pressure", "Impact pressure by spacing", "particles", "kPa", {}};
    const std::vector<observe::BuildingImpact>& finest = runs.back();
    double largest = 0;
    for (const observe::BuildingImpact& impact : finest) largest = std::max(largest, impact.peak_force);
    for (std::size_t b = 0; b < finest.size(); ++b) {
        Series series{finest[b].name, Series::Style::line, {}, {}};
        for (std::size_t r = 0; r < runs.size(); ++r) {
            const observe::BuildingImpact& impact = runs[r][b];
            series.x.push_back(spec.counts[r]);
            series.y.push_back(impact.peak_impact_pressure / 1e3);
            if (r + 1 == runs.size() || finest[b].peak_force < 0.05 * largest) continue;
            const std::string where = fmt::format("{}, {:g} particles", impact.name, spec.counts[r]);
            outcome.measurements.push_back({"force", where, impact.peak_force, finest[b].peak_force});
            outcome.measurements.push_back(
                {"pressure", where, impact.peak_impact_pressure, finest[b].peak_impact_pressure});
        }
        pressures.series.push_back(std::move(series));
    }
    outcome.charts.push_back(std::move(pressures));
    return outcome;
}

Computation prepare(Parameters& parameters, const Setting& setting) {
    ImpactSpec spec;
    spec.counts = parameters.numbers("particle_counts", {.low = 100, .high = 1e7}, {1000, 3000, 10000, 30000});
    std::sort(spec.counts.begin(), spec.counts.end());
    spec.slope = parameters.number("slope_deg", {.low = 5, .high = 60}, 25) * M_PI / 180;
    spec.end = parameters.number("end_time_s", {.low = 0, .low_included = false}, 8);
    return [spec, setting](const Watch& watch) { return compute(spec, setting, watch); };
}

}  // namespace structure_impact

Kind structure_impact_kind() {
    return {"structure_impact", "force and pressure on a house and walls at several spacings",
            structure_impact::quantities, structure_impact::prepare};
}

}  // namespace talus::validate
