#include "observe/energy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus::observe {
namespace {

double total(const TimeSample& row) {
    return row.kinetic_energy + row.potential_energy;
}

/// The lowest ground of a cell and its eight neighbours: on a cliff the speed of a cell belongs to both levels.
double lowest_around(const Grid<float>& ground, int column, int row) {
    const GridGeometry& g = ground.geometry;
    float lowest = std::numeric_limits<float>::infinity();
    for (int r = std::max(0, row - 1); r <= std::min(g.rows - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(g.columns - 1, column + 1); ++c) {
            if (ground.at(c, r) < lowest) lowest = ground.at(c, r);  // false where it is unknown
        }
    }
    return lowest;
}

}  // namespace

void EnergyAccount::bring(double mass, double energy, double highest, double thickness) {
    brought_ += energy;
    brought_mass_ += mass;
    highest_ = std::max(highest_, highest);
    thickness_ = std::max(thickness_, thickness);
}

void EnergyAccount::follow(const TimeSample& now, double mass) {
    brought_ += total(now) - total_;
    brought_mass_ = std::max(brought_mass_, mass);
    total_ = total(now);
}

void EnergyAccount::add(const TimeSample& row, double present, double density) {
    const double height = present > 0 ? row.potential_energy / (present * gravity_) : mean_height_;
    // What is entrained comes from the ground under moving debris, at rest.
    const double entrained = density * (row.volume_entrained - entrained_);
    brought_ += entrained * gravity_ * std::max(height, mean_height_);
    brought_mass_ += entrained;
    entrained_ = row.volume_entrained;
    mean_height_ = height;
    total_ = total(row);
    const double gained = total_ - brought_;
    if (gained <= gained_) return;
    gained_ = gained;
    gained_time_ = row.time;
}

double EnergyAccount::greatest_speed() const {
    return std::sqrt(2 * gravity_ * (std::max(0.0, highest_) + thickness_));
}

Energy EnergyAccount::measure(const HazardMaps& maps, const Grid<float>& ground, double slack) const {
    Energy energy;
    const GridGeometry& g = maps.peak_speed.geometry;
    double lowest = std::numeric_limits<double>::infinity();
    for (int row = 0; row < g.rows; ++row) {
        for (int column = 0; column < g.columns; ++column) {
            const double speed = maps.peak_speed.at(column, row);
            const double floor = lowest_around(ground, column, row);
            if (std::isnan(speed) || !std::isfinite(floor)) continue;
            lowest = std::min(lowest, floor);
            ++energy.cells;
            const double fall = std::max(0.0, highest_ - floor);
            // Pressure hands energy on to a front: over a level bed it runs at 2 sqrt(g h) (Ritter 1892), a thickness
            // more of velocity head than the fall of its surface.
            const double allowed = fall + thickness_ + slack, share = speed * speed / (2 * gravity_ * allowed);
            if (share > Energy::share_limit) ++energy.cells_above;
            if (!(allowed > 0) || share <= energy.share) continue;
            energy.share = share;
            energy.speed = speed;
            energy.allowed_speed = std::sqrt(2 * gravity_ * allowed);
            energy.fall = fall;
            energy.at = g.centre(column, row);
        }
    }
    const double available = brought_ - brought_mass_ * gravity_ * lowest;
    if (energy.cells == 0 || !(available > 0)) return energy;
    energy.gained = gained_ / available;
    energy.gained_time = gained_time_;
    return energy;
}

}  // namespace talus::observe
