// Inflow during the run, and releases that fail in it.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "report/number_text.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

double density_of(const params::InflowSample& row, const terrain::Inflow& inflow, const scene::Scene& scene) {
    return inflow.has_density() ? row.density : scene.spec.material.rest_density;
}

std::string way_in(const terrain::Inflow& inflow) {
    if (!inflow.over_area()) return "across a line";
    double area = 0;
    for (const Polygon& part : inflow.area) area += plan_area(part);
    return fmt::format("over {} m², {}", fixed(area, 0),
                       inflow.spec.direction ? fmt::format("towards {}° from north", fixed(*inflow.spec.direction, 0))
                                             : "down the slope");
}

Json mass_of(const terrain::Inflow& inflow) {
    const double mass = inflow.mass_until(inflow.hydrograph.back().time);
    return {{"mass_t", mass / 1e3}, {"mean_density_kgpm3", mass / inflow.volume()}};
}

}  // namespace

Json initiation(const run::RunResult& result) {
    if (result.initiations.empty()) return {};
    Json list = Json::array();
    for (const run::Initiation& one : result.initiations) {
        const bool held = std::isnan(one.ratio), failed = !std::isnan(one.failed_at);
        list.push_back({{"release", one.release},
                        {"held", held},
                        {"failed", failed},
                        {"stood", !held && !failed},
                        {"failed_at_s", failed ? Json(one.failed_at) : Json()},
                        {"pore_pressure_ratio", held ? Json() : Json(one.ratio)}});
    }
    return {{"list", std::move(list)}, {"moved_m", result.particle_spacing}};
}

Json inflow(const scene::Scene& scene, const run::RunResult& result) {
    if (scene.inflows.empty()) return {};
    ValueRange time{0, result.simulated_time}, discharges{0, 0}, velocities{0, 0};
    for (const terrain::Inflow& one : scene.inflows) {
        for (const params::InflowSample& row : one.hydrograph) {
            time.include(row.time);
            discharges.include(row.discharge);
            velocities.include(row.velocity);
        }
    }
    const auto any = [&](const auto& holds) { return std::any_of(scene.inflows.begin(), scene.inflows.end(), holds); };
    const bool densities = any([](const terrain::Inflow& one) { return one.has_density(); });
    ValueRange density_range{0, 0};
    for (const terrain::Inflow& one : scene.inflows) {
        for (const params::InflowSample& row : one.hydrograph)
            density_range.include(1.08 * density_of(row, one, scene));
    }
    discharges.high *= 1.08;
    velocities.high *= 1.08;
    Plot discharge(66, 24, 412, 230, time, discharges), velocity(570, 24, 412, 230, time, velocities),
        density(66, 320, 412, 230, time, density_range);
    discharge.axes("time, s", "discharge, m³/s");
    velocity.axes("time, s", "velocity, m/s");
    density.axes("time, s", "density, kg/m³");
    Json list = Json::array();
    for (std::size_t k = 0; k < scene.inflows.size(); ++k) {
        const terrain::Inflow& one = scene.inflows[k];
        std::vector<double> t, q, v, rho;
        for (const params::InflowSample& row : one.hydrograph) {
            t.push_back(row.time);
            q.push_back(row.discharge);
            v.push_back(row.velocity);
            rho.push_back(density_of(row, one, scene));
        }
        const std::string colour = fmt::format("series v{}", k % 8);
        discharge.line(t, q, colour);
        velocity.line(t, v, colour);
        density.line(t, rho, colour);
        list.push_back({{"name", one.name},
                        {"place", way_in(one)},
                        {"volume_m3", one.volume()},
                        {"volume_by_the_end_m3", one.volume_until(result.simulated_time)},
                        {"mass", one.has_density() ? mass_of(one) : Json()}});
    }
    Chart chart{"Discharge and velocity of the inflows over time", 1000, densities ? 616.0 : 320.0, {}};
    chart.plots = {std::move(discharge), std::move(velocity)};
    if (densities) chart.plots.push_back(std::move(density));
    return {{"list", std::move(list)},
            {"over_lines", any([](const terrain::Inflow& one) { return !one.over_area(); })},
            {"over_areas", any([](const terrain::Inflow& one) { return one.over_area(); })},
            {"densities", densities},
            {"chart", chart_json(chart)}};
}

}  // namespace talus::report
