#include "run/fault_record.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace talus::run {
namespace {

using nlohmann::json;

bool is_finite(const LocalPoint& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The bad particles, those that are not finite first; where all are, the fastest.
struct Bad {
    std::optional<std::uint32_t> id;
    std::uint32_t count = 0;  ///< of those that are not finite
};

Bad find_bad(const sim::State& state) {
    Bad bad;
    float fastest = -1;
    std::optional<std::uint32_t> fastest_id;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint v = state.velocity.at(i);
        if (!is_finite(state.position.at(i)) || !is_finite(v)) {
            if (bad.count++ == 0) bad.id = state.id[i];
        } else if (dot(v, v) > fastest) {
            fastest = dot(v, v);
            fastest_id = state.id[i];
        }
    }
    if (!bad.id) bad.id = fastest_id;
    return bad;
}

std::string state_table(const sim::State& state) {
    std::string text = "id,x_local_m,y_local_m,z_local_m,vx_mps,vy_mps,vz_mps,held,asleep\n";
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const LocalPoint p = state.position.at(i), v = state.velocity.at(i);
        text += fmt::format("{},{},{},{},{},{},{},{},{}\n", state.id[i], p.x, p.y, p.z, v.x, v.y, v.z,
                            static_cast<int>(state.held[i]), static_cast<int>(state.asleep[i]));
    }
    return text;
}

}  // namespace

FaultRecord record_fault(const sim::Model& model, const sim::Ground& ground, const sim::State& good,
                         const sim::State& bad, const std::string& reason) {
    const WorldPoint& origin = ground.terrain.frame().origin;
    FaultRecord record;
    record.state_table = state_table(good);
    record.content = {{"fault", reason},
                      {"time_s", bad.time},
                      {"step", bad.step},
                      {"last_good", {{"time_s", good.time}, {"step", good.step}, {"particles", good.count}}},
                      {"origin_m", {origin.x, origin.y, origin.z}},
                      {"particle", nullptr}};
    const Bad found = find_bad(bad);
    record.content["particles_not_finite"] = found.count;
    const auto end = good.id.begin() + good.count;
    const auto place = found.id ? std::find(good.id.begin(), end, *found.id) : end;
    if (place == end) return record;  // it came since

    const auto i = static_cast<std::size_t>(place - good.id.begin());
    const LocalPoint at = good.position.at(i);
    json neighbours = json::array();
    for (std::uint32_t k = 0; k < good.count; ++k) {
        const double distance = length(good.position.at(k) - at);
        if (k == i || !(distance < model.support_radius)) continue;
        neighbours.push_back({{"id", good.id[k]}, {"distance_m", distance}});
    }
    const GridGeometry& grid = ground.terrain.elevation().geometry;
    const WorldPoint world{origin.x + at.x, origin.y + at.y, origin.z + at.z};
    const int column = static_cast<int>(std::floor((world.x - grid.x_min) / grid.cell));
    const int row = static_cast<int>(std::floor((world.y - grid.y_min) / grid.cell));
    const double speed = length(good.velocity.at(i));
    record.sentence = fmt::format(
        "; particle {}{} was at ({:.2f}, {:.2f}, {:.2f}), in column {} and row {} of the terrain from its south-west "
        "corner, at {:.3g} m/s with {} neighbours at t = {:.4g} s",
        *found.id, found.count > 1 ? fmt::format(", the first of {},", found.count) : "", world.x, world.y, world.z,
        column, row, speed, neighbours.size(), good.time);
    record.content["particle"] = {{"id", *found.id},    {"x_m", world.x},          {"y_m", world.y},
                                  {"z_m", world.z},     {"speed_mps", speed},      {"terrain_column", column},
                                  {"terrain_row", row}, {"neighbours", neighbours}};
    return record;
}

}  // namespace talus::run
