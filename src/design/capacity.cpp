#include "design/capacity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>

#include "core/grid.hpp"
#include "observe/barrier_line.hpp"
#include "params/spec.hpp"
#include "terrain/barrier.hpp"

namespace talus::design {
namespace {

constexpr int stations = 41;            ///< along the line
constexpr int most_cells_across = 600;  ///< of the grid that is filled

struct Station {
    PlanPoint at;
    PlanPoint left;  ///< unit normal
};

std::vector<Station> stations_of(const std::vector<PlanPoint>& line) {
    const double length = terrain::length_of(line);
    std::vector<Station> made;
    for (int k = 0; k < stations; ++k) {
        const double chainage = length * (k + 0.5) / stations;
        const double step = length / stations / 4;
        const PlanPoint a = observe::point_at(line, chainage - step), b = observe::point_at(line, chainage + step);
        const double dx = b.x - a.x, dy = b.y - a.y, d = std::hypot(dx, dy);
        made.push_back({observe::point_at(line, chainage), {-dy / d, dx / d}});
    }
    return made;
}

/// Mean ground at a distance to one side of the line; NaN: unknown everywhere.
double mean_ground(const terrain::Terrain& terrain, const std::vector<Station>& all, double offset) {
    double sum = 0;
    int known = 0;
    for (const Station& s : all) {
        const double z = terrain.elevation_at({s.at.x + offset * s.left.x, s.at.y + offset * s.left.y});
        if (std::isnan(z)) continue;
        sum += z;
        ++known;
    }
    return known > 0 ? sum / known : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

int upstream_side(const terrain::Terrain& terrain, const std::vector<PlanPoint>& line) {
    const std::vector<Station> all = stations_of(line);
    const double away = std::max(3 * terrain.cell(), terrain::length_of(line) / 4);
    const double left = mean_ground(terrain, all, away), right = mean_ground(terrain, all, -away);
    return left >= right || std::isnan(right) ? 1 : -1;
}

double ground_slope(const terrain::Terrain& terrain, const std::vector<PlanPoint>& line, int side, double distance) {
    const std::vector<Station> all = stations_of(line);
    return (mean_ground(terrain, all, side * distance) - mean_ground(terrain, all, 0)) / distance;
}

Storage storage_behind(const terrain::Terrain& terrain, const std::vector<PlanPoint>& line, int side, double height,
                       double thickness, double slope) {
    params::BarrierSpec shape;
    shape.line = line;
    const observe::BarrierLine plan(terrain, shape);
    double crest = std::numeric_limits<double>::infinity();
    for (const Station& s : stations_of(line)) {
        const double ground = terrain.elevation_at(s.at);
        if (!std::isnan(ground)) crest = std::min(crest, ground + height);
    }
    // As far as a surface on ground of one part in fifty could reach, and no farther than the terrain.
    const double reach = 50 * height + 4 * terrain.cell();
    Extent area{line.front().x, line.front().y, line.front().x, line.front().y};
    for (const PlanPoint& p : line) area.include(p);
    area = area.grown(reach);
    const Extent known = terrain.elevation().geometry.extent();
    area = {std::max(area.x_min, known.x_min), std::max(area.y_min, known.y_min), std::min(area.x_max, known.x_max),
            std::min(area.y_max, known.y_max)};
    const double across = std::max(area.x_max - area.x_min, area.y_max - area.y_min);
    const double cell = std::max(std::min(terrain.cell(), height / 4), across / most_cells_across);
    const GridGeometry g{area.x_min, area.y_min, cell, std::max(1, static_cast<int>((area.x_max - area.x_min) / cell)),
                         std::max(1, static_cast<int>((area.y_max - area.y_min) / cell))};

    const WorldPoint& origin = terrain.frame().origin;
    const auto place_at = [&](const PlanPoint& p) { return plan.place_of({p.x - origin.x, p.y - origin.y}); };
    const auto is_behind = [&](const PlanPoint& p) {
        const auto place = place_at(p);
        return place.side == side && place.distance >= thickness / 2;
    };
    // Below the surface, m; NaN: unknown ground.
    const auto space_at = [&](const PlanPoint& p) {
        return crest + slope * (place_at(p).distance - thickness / 2) - terrain.elevation_at(p);
    };
    Grid<float> room(g, std::numeric_limits<float>::quiet_NaN());  // mean of space_at; NaN: not behind the barrier
    Grid<float> covered(g, 0);                                     // share of the cell that is behind it
    std::queue<std::pair<int, int>> wet;
    Grid<std::uint8_t> filled(g, 0);
    // A barrier cuts cells where debris is deepest: those count with the part behind it.
    constexpr int parts = 6;
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const PlanPoint p = g.centre(column, row);
            int corners = 0;
            for (const double right : {-0.5, 0.5}) {
                for (const double up : {-0.5, 0.5}) corners += is_behind({p.x + right * cell, p.y + up * cell}) ? 1 : 0;
            }
            if (corners == 0 && !is_behind(p)) continue;
            const int n = corners < 4 ? parts : 1;
            double sum = 0;
            int behind = 0;
            for (int k = 0; k < n * n; ++k) {
                const int east = k % n, north = k / n;
                const double right = (east + 0.5) / n - 0.5, up = (north + 0.5) / n - 0.5;
                const PlanPoint q{p.x + right * cell, p.y + up * cell};
                const double space = space_at(q);
                if (std::isnan(space) || (n > 1 && !is_behind(q))) continue;
                sum += space;
                ++behind;
            }
            if (behind == 0) continue;
            room.at(column, row) = static_cast<float>(sum / behind);
            covered.at(column, row) = static_cast<float>(behind) / static_cast<float>(n * n);
            if (sum > 0 && place_at(p).distance < thickness / 2 + 2 * cell) {
                filled.at(column, row) = 1;
                wet.emplace(column, row);
            }
        }
    }
    Storage storage;
    while (!wet.empty()) {
        const auto [column, row] = wet.front();
        wet.pop();
        const double area_here = static_cast<double>(covered.at(column, row)) * cell * cell;
        const double distance = place_at(g.centre(column, row)).distance;
        storage.volume += static_cast<double>(room.at(column, row)) * area_here;
        storage.area += area_here;
        storage.reach = std::max(storage.reach, distance);
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            const int c = column + dx, r = row + dy;
            if (c < 0 || r < 0 || c >= g.columns || r >= g.rows) continue;
            const float space = room.at(c, r);
            if (std::isnan(space)) {
                // Beyond a perpendicular, on ground that lies lower than the surface here.
                const PlanPoint p = g.centre(c, r);
                const auto place = place_at(p);
                const double ground = terrain.elevation_at(p);
                const double surface = crest + slope * distance;
                storage.open_sides = storage.open_sides || (place.side == 0 && ground < surface);
            } else if (space > 0 && filled.at(c, r) == 0) {
                filled.at(c, r) = 1;
                wet.emplace(c, r);
            }
        }
    }
    return storage;
}

}  // namespace talus::design
