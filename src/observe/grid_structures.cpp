#include "observe/grid_structures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "observe/grid_flow.hpp"
#include "observe/wall_patches.hpp"

namespace talus::observe {
namespace {

/// Cells farther from a wall than this are not before it, in cells: a structure stands on cells that its walls cross.
constexpr double farthest_cell = 2.5;

/// Whether a column of a wall stands on a lower part of its own building: no cells are before it.
bool above_own_part(const terrain::Building& building, const PlanPoint& before) {
    return std::any_of(building.footprint.begin(), building.footprint.end(),
                       [&](const Polygon& part) { return contains(part, before); });
}

}  // namespace

GridStructures::GridStructures(const depth::Solver& solver, const terrain::Terrain& terrain,
                               const std::vector<terrain::Building>& buildings,
                               const std::vector<StructureCells>& cells, const params::OutputSpec& outputs)
    : outputs_(outputs),
      grid_(solver.geometry()),
      origin_{terrain.frame().origin.x, terrain.frame().origin.y},
      density_(solver.material().rest_density),
      gravity_(solver.material().gravity),
      now_(buildings.size()),
      sums_(outputs.impact_filter_window) {
    for (const terrain::Building& building : buildings) {
        impacts_.push_back({.name = building.name, .is_barrier = building.barrier.has_value()});
    }
    for (std::size_t b = 0; b < buildings.size(); ++b) {
        if (buildings[b].barrier && stands(buildings[b])) add_barrier(solver, terrain, buildings[b], b, cells[b].cells);
    }
    add_walls(solver, terrain, buildings);
    sums_.resize(impacts_.size() + walls_.size());
}

PlanPoint GridStructures::local_centre(int column, int row) const {
    const PlanPoint world = grid_.centre(column, row);
    return {world.x - origin_.x, world.y - origin_.y};
}

void GridStructures::add_walls(const depth::Solver& solver, const terrain::Terrain& terrain,
                               const std::vector<terrain::Building>& buildings) {
    const double edge = outputs_.impact_patch_edge;
    const WallPatches patches(terrain, buildings, edge, edge);
    for (const WallPatches::Column& column : patches.columns()) {
        if (column.roof) continue;
        const auto b = static_cast<std::size_t>(column.building);
        const PlanPoint out{column.along_y, -column.along_x};
        const PlanPoint middle{column.x + column.along_x * column.width / 2,
                               column.y + column.along_y * column.width / 2};
        if (above_own_part(buildings[b], {middle.x + 0.02 * out.x + origin_.x, middle.y + 0.02 * out.y + origin_.y})) {
            continue;
        }
        Wall wall{.building = b,
                  .towards_x = -out.x,
                  .towards_y = -out.y,
                  .width = column.width,
                  .height = column.rows * column.row_height,
                  .patch_height = column.row_height,
                  .patch_area = column.area,
                  .side = 0,
                  .first = cells_.size(),
                  .last = 0};
        add_cells(solver, {column.x, column.y}, out, {column.along_x, column.along_y}, column.width);
        wall.last = cells_.size();
        if (wall.first == wall.last) continue;
        for (const Barrier& barrier : barriers_) {
            if (barrier.building == b) wall.side = barrier.line.place_of({middle.x + out.x, middle.y + out.y}).side;
        }
        walls_.push_back(wall);
    }
}

/// The cells that are open within a patch edge before a piece of wall of some width from `at` along it. They begin
/// where the cells end on which structures stand.
void GridStructures::add_cells(const depth::Solver& solver, PlanPoint at, PlanPoint out, PlanPoint along,
                               double width) {
    const double cell = grid_.cell, edge = outputs_.impact_patch_edge;
    const auto find = [&](double across, double away, int& column, int& row) {
        const double x = at.x + along.x * across + out.x * away + origin_.x;
        const double y = at.y + along.y * across + out.y * away + origin_.y;
        column = static_cast<int>(std::floor((x - grid_.x_min) / cell));
        row = static_cast<int>(std::floor((y - grid_.y_min) / cell));
        return column >= 0 && row >= 0 && column < grid_.columns && row < grid_.rows && solver.known(column, row) &&
               !solver.built(column, row);
    };
    const int across = std::max(1, static_cast<int>(std::ceil(2 * width / cell)));
    const int deep = std::max(1, static_cast<int>(std::ceil(edge / cell)));
    const std::size_t first = cells_.size();
    double all = 0;
    for (int i = 0; i < across; ++i) {
        const double place = (i + 0.5) / across * width;
        int column = 0, row = 0;
        double begin = 1e-3;
        while (!find(place, begin, column, row) && begin < farthest_cell * cell) begin += cell / 16;
        for (int k = 0; k < deep; ++k) {
            const double away = deep == 1 ? begin : begin + (k + 0.5) / deep * edge;
            if (!find(place, away, column, row)) continue;
            const auto same = std::find_if(cells_.begin() + static_cast<std::ptrdiff_t>(first), cells_.end(),
                                           [&](const Cell& c) { return c.column == column && c.row == row; });
            if (same == cells_.end()) {
                cells_.push_back({column, row, 1});
            } else {
                same->weight += 1;
            }
            all += 1;
        }
    }
    for (std::size_t k = first; k < cells_.size(); ++k) cells_[k].weight /= all;
}

void GridStructures::add_barrier(const depth::Solver& solver, const terrain::Terrain& terrain,
                                 const terrain::Building& building, std::size_t index,
                                 const std::vector<std::size_t>& cells) {
    Barrier barrier{.building = index, .line = {terrain, *building.barrier}, .crossings = {}, .cells = cells};
    std::sort(barrier.cells.begin(), barrier.cells.end());
    const auto ground = [&](int column, int row) {
        const PlanPoint at = local_centre(column, row);
        return double{terrain.sample(static_cast<float>(at.x), static_cast<float>(at.y)).height};
    };
    const Extent near = barrier.line.extent().grown(2 * grid_.cell);
    for (int row = 0; row < grid_.rows; ++row) {
        for (int column = 0; column < grid_.columns; ++column) {
            const PlanPoint at = local_centre(column, row);
            if (!near.contains(at) || !solver.known(column, row)) continue;
            for (const bool north : {false, true}) {
                const int c = column + (north ? 0 : 1), r = row + (north ? 1 : 0);
                if (c >= grid_.columns || r >= grid_.rows || !solver.known(c, r)) continue;
                const BarrierLine::Crossing crossing = barrier.line.crossing(at, local_centre(c, r));
                if (crossing.net == 0) continue;
                const double crest = barrier.line.opening_crest(crossing.chainage);
                barrier.crossings.push_back({faces_.size(),
                                             static_cast<double>(crossing.net),
                                             {crest - ground(column, row), crest - ground(c, r)}});
                faces_.push_back({column, row, north});
            }
        }
    }
    barriers_.push_back(std::move(barrier));
}

void GridStructures::measure_walls(const depth::Solver& solver) {
    std::fill(now_.begin(), now_.end(), Now{});
    const double time_step = solver.time_step();
    for (std::size_t w = 0; w < walls_.size(); ++w) {
        const Wall& wall = walls_[w];
        double depth = 0, x = 0, y = 0, up = 0;
        for (std::size_t k = wall.first; k < wall.last; ++k) {
            const auto [c, r, weight] = cells_[k];
            const double part = weight * solver.depth_at(c, r), u = solver.u_at(c, r), v = solver.v_at(c, r);
            depth += part;
            x += part * u;
            y += part * v;
            up += part * (u * solver.slope_x_at(c, r) + v * solver.slope_y_at(c, r) + solver.climb_at(c, r));
        }
        if (!(depth > 0)) continue;
        x /= depth;
        y /= depth;
        up /= depth;
        BuildingImpact& impact = impacts_[wall.building];
        Now& now = now_[wall.building];
        const double to_wall = std::max(0.0, x * wall.towards_x + y * wall.towards_y);
        const double dynamic = density_ * to_wall * to_wall;
        // Force on a metre of the wall up to a height: momentum flux and weight of the flow before it.
        const auto force_below = [&](double height) {
            const double wet = std::min(depth, height);
            return dynamic * wet + density_ * gravity_ * wet * (depth - wet / 2);
        };
        const double pressure = force_below(wall.patch_height) * wall.width / wall.patch_area;  // the lowest: highest
        now.force += force_below(wall.height) * wall.width;
        now.depth = std::max(now.depth, depth);
        sums_.add(impacts_.size() + w, pressure * time_step);
        if (depth <= outputs_.arrival_depth) continue;  // too thin to hit, or to have a velocity
        now.dynamic_pressure = std::max(now.dynamic_pressure, dynamic);
        impact.peak_speed = std::max(impact.peak_speed, std::sqrt(x * x + y * y + up * up));
        if (!impact.hit) {
            impact.hit = true;
            impact.first_hit_time = solver.time();
        }
    }
    for (std::size_t b = 0; b < now_.size(); ++b) {
        if (now_[b].force > 0) sums_.add(b, now_[b].force * time_step);
    }
    sums_.advance(solver.time(), time_step);
    for (std::size_t w = 0; w < walls_.size(); ++w) {
        double& highest = now_[walls_[w].building].pressure;
        highest = std::max(highest, sums_.rate(impacts_.size() + w));
    }
    for (std::size_t b = 0; b < now_.size(); ++b) {
        BuildingImpact& impact = impacts_[b];
        if (!impact.hit) continue;
        impact.impulse += now_[b].force * time_step;
        impact.peak_force = std::max(impact.peak_force, sums_.rate(b));
        impact.peak_impact_pressure = std::max(impact.peak_impact_pressure, now_[b].pressure);
        impact.peak_depth = std::max(impact.peak_depth, now_[b].depth);
        impact.peak_dynamic_pressure = std::max(impact.peak_dynamic_pressure, now_[b].dynamic_pressure);
    }
}

void GridStructures::count_crossings(const depth::Solver& solver) {
    for (Barrier& barrier : barriers_) {
        BuildingImpact& impact = impacts_[barrier.building];
        bool goes_over = false;
        for (const Crossing& crossing : barrier.crossings) {
            const double passed = solver.passed()[crossing.face];
            if (passed == 0) continue;
            const auto [column, row, north] = faces_[crossing.face];
            const bool back = passed < 0;  // from the cell after the face
            const double depth = solver.depth_at(column + (back && !north ? 1 : 0), row + (back && north ? 1 : 0));
            const double room = crossing.room[back ? 1 : 0];
            const double through = room > 0 ? std::min(1.0, room / std::max(depth, 1e-9)) : 0;
            barrier.over += crossing.sign * passed * (1 - through);
            barrier.through += crossing.sign * passed * through;
            goes_over = goes_over || (through < 1 && depth > outputs_.arrival_depth);
        }
        // In the direction with the larger total volume, as of particles.
        const double direction = barrier.over + barrier.through < 0 ? -1 : 1;
        impact.overtopped_volume = std::max(0.0, direction * barrier.over);
        impact.passed_volume = std::max(0.0, direction * barrier.through);
        if (goes_over && impact.hit && std::isnan(impact.first_overtopping_time))
            impact.first_overtopping_time = solver.time();
    }
}

/// Debris on a side of a barrier; what lies on its crest is not behind it.
std::vector<DebrisColumn> GridStructures::columns_of(const depth::Solver& solver, const Barrier& barrier,
                                                     int side) const {
    const auto own = [&](int column, int row) {
        return column >= 0 && row >= 0 && column < grid_.columns && row < grid_.rows &&
               std::binary_search(barrier.cells.begin(), barrier.cells.end(), grid_.index(column, row));
    };
    std::vector<DebrisColumn> columns;
    for (int row = 0; row < grid_.rows; ++row) {
        depth::for_each_deeper(solver.row(row), 0, [&](int column) {
            if (own(column, row)) return;
            const double depth = solver.depth_at(column, row);
            const BarrierLine::Place place = barrier.line.place_of(local_centre(column, row));
            if (place.side != side) return;
            const bool at_face = place.distance < barrier.line.half_thickness() + grid_.cell || own(column - 1, row) ||
                                 own(column + 1, row) || own(column, row - 1) || own(column, row + 1);
            const double bed = solver.bed_at(column, row);
            const double speed = speed_of(solver, column, row);
            columns.push_back({column, row, depth * grid_.cell * grid_.cell, bed, bed + depth,
                               speed < outputs_.deposited_speed, at_face});
        });
    }
    return columns;
}

GridStructures::Filling GridStructures::filling(const depth::Solver& solver, const Barrier& barrier) const {
    const double left = retained_volume(columns_of(solver, barrier, 1));
    const double right = retained_volume(columns_of(solver, barrier, -1));
    const double gone = barrier.over + barrier.through;
    const int upstream = (gone != 0 ? gone > 0 : left >= right) ? 1 : -1;
    Filling filling{upstream > 0 ? left : right, 0};
    for (const Wall& wall : walls_) {
        if (wall.building != barrier.building || wall.side != upstream) continue;
        double depth = 0;
        for (std::size_t k = wall.first; k < wall.last; ++k) {
            depth += cells_[k].weight * solver.depth_at(cells_[k].column, cells_[k].row);
        }
        filling.height = std::max(filling.height, depth);
    }
    return filling;
}

void GridStructures::add_rows(const depth::Solver& solver) {
    for (std::size_t b = 0; b < impacts_.size(); ++b) {
        if (!impacts_[b].hit) continue;
        const bool too_thin = now_[b].depth > 0 && now_[b].depth <= outputs_.arrival_depth;
        impacts_[b].history.push_back({.time = solver.time(),
                                       .force = sums_.rate(b),
                                       .impact_pressure = now_[b].pressure,
                                       .depth = now_[b].depth,
                                       .dynamic_pressure = too_thin ? never : now_[b].dynamic_pressure,
                                       .impulse = impacts_[b].impulse,
                                       .overtopped_volume = impacts_[b].overtopped_volume,
                                       .passed_volume = impacts_[b].passed_volume});
    }
    for (const Barrier& barrier : barriers_) {
        BuildingImpact& impact = impacts_[barrier.building];
        if (!impact.hit) continue;
        const Filling now = filling(solver, barrier);
        StructureSample& sample = impact.history.back();
        sample.retained_volume = impact.retained_volume = now.volume;
        sample.filling_height = now.height;
        impact.peak_retained_volume = std::max(impact.peak_retained_volume, now.volume);
        impact.peak_filling_height = std::max(impact.peak_filling_height, now.height);
    }
}

void GridStructures::after_step(const depth::Solver& solver, bool row) {
    if (impacts_.empty()) return;
    measure_walls(solver);
    count_crossings(solver);
    if (row) add_rows(solver);
}

std::vector<BuildingImpact> GridStructures::impacts(const depth::Solver& solver) const {
    std::vector<BuildingImpact> impacts = impacts_;
    for (const Barrier& barrier : barriers_) {
        impacts[barrier.building].retained_volume = filling(solver, barrier).volume;
    }
    return impacts;
}

}  // namespace talus::observe
