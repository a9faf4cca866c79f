// What a zoom was, and the balance across its boundary.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"

namespace talus::report {
namespace {

Json balance_rows(const run::ZoomRecord& zoom, double volume_left) {
    Json rows = table({{"quantity", "Across the boundary", ""},
                       {"unit", "Unit", "", "", ""},
                       {"depth_averaged", "Depth-averaged", "", "f1"},
                       {"particles", "Particles", "", "f1"},
                       {"difference_percent", "Difference", "%", "d2"}});
    const auto add = [&](const char* quantity, const char* unit, double flow, double particles, bool compared) {
        rows["rows"].push_back({{"quantity", quantity},
                                {"unit", unit},
                                {"depth_averaged", flow},
                                {"particles", particles},
                                {"difference_percent",
                                 compared && flow > 0 ? number_or_null<Json>(100 * (particles / flow - 1)) : Json()}});
    };
    constexpr double kilo = 1e3;
    add("Volume in", "m³", zoom.volumes.in, zoom.brought_volume, true);
    add("Momentum in", "kN s", std::hypot(zoom.momentum.x, zoom.momentum.y) / kilo,
        std::hypot(zoom.brought_momentum.x, zoom.brought_momentum.y) / kilo, true);
    add("Momentum in, eastward", "kN s", zoom.momentum.x / kilo, zoom.brought_momentum.x / kilo, false);
    add("Momentum in, northward", "kN s", zoom.momentum.y / kilo, zoom.brought_momentum.y / kilo, false);
    add("Volume out", "m³", zoom.volumes.out, volume_left, false);
    return rows;
}

Json discharge_chart(const run::ZoomRecord& zoom) {
    constexpr std::size_t merged = 5;  // intervals, against the steps of single cells
    std::vector<double> time, discharge;
    ValueRange times{0, zoom.simulated_time}, discharges{0, 1e-3};
    for (std::size_t k = 0; k < zoom.discharge.size(); k += merged) {
        const std::size_t end = std::min(k + merged, zoom.discharge.size());
        double sum = 0;
        for (std::size_t i = k; i < end; ++i) sum += zoom.discharge[i];
        time.push_back(static_cast<double>(k + end) / 2 * run::BoundaryFlow::interval);
        discharge.push_back(sum / static_cast<double>(end - k));
        discharges.include(1.1 * discharge.back());
    }
    Chart chart{"Inflow across the boundary of the zoom", 1000, 250, {}};
    Plot plot(66, 20, 916, 170, times, discharges);
    plot.axes("time, s", "discharge, m³/s");
    plot.line(time, discharge, "series blue");
    chart.plots.push_back(std::move(plot));
    return chart_json(chart);
}

}  // namespace

std::string left_text(const scene::Scene& scene, const run::RunResult& result) {
    if (result.zoom || !scene.spec.terrain.extent) return fmt::format("debris left the {}", result.domain());
    return "debris left the part of the terrain that terrain.extent_m takes; a larger part shows how far it goes";
}

bool outside_zoom(const scene::Scene& scene, const run::RunResult& result, double chainage) {
    return result.zoom && !scene.flow_path.empty() && !result.covers(scene.flow_path.point_at(chainage));
}

Json zoom(const run::RunResult& result) {
    if (!result.zoom) return {};
    const run::ZoomRecord& zoom = *result.zoom;
    const Extent e = extent_of(zoom.area);
    Json corners = Json::array();
    for (const PlanPoint& p : zoom.area.outer) corners.push_back({p.x, p.y});
    return {{"around", zoom.around.empty() ? Json() : Json(zoom.around)},
            {"width_m", e.width()},
            {"height_m", e.height()},
            {"polygon_m", std::move(corners)},
            {"surroundings_m", zoom.surroundings},
            {"grid_cell_m", zoom.grid_cell},
            {"depth_averaged_wall_time_s", zoom.wall_time},
            {"particle_spacing_m", zoom.particle_spacing},
            {"thickness_m", zoom.thickness},
            {"layers", zoom.layers()},
            {"event_volume_m3", zoom.event_volume},
            {"volume_in_m3", zoom.volumes.in},
            {"volume_out_m3", zoom.volumes.out},
            {"sampled_in_m3", zoom.volumes.sampled_in},
            {"sampled_out_m3", zoom.volumes.sampled_out},
            {"first_time_s", zoom.first_time()},
            {"pieces", zoom.pieces},
            {"balance", balance_rows(zoom, result.observation.at_end().volume_left)},
            {"chart", discharge_chart(zoom)}};
}

}  // namespace talus::report
