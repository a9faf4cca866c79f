// What a solver knows of the ground: its bed with the slopes of that, and what covers it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "depth/solver.hpp"

namespace talus::depth {
namespace {

/// Of the floats at `range`.
double float_spacing(double range) {
    return std::ldexp(1.0, std::ilogb(std::max(range, 1.0)) - std::numeric_limits<float>::digits + 1);
}

}  // namespace

void Solver::set_bed(const Grid<double>& bed) {
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (const double z : bed.values) {
        if (std::isnan(z)) continue;
        lowest = std::min(lowest, z);
        highest = std::max(highest, z);
    }
    elevation_spacing_ = float_spacing(highest - lowest);
    const auto rounded = [&](double z) {
        return static_cast<float>(std::round(z / elevation_spacing_) * elevation_spacing_);
    };
    for (int row = 0; row < geometry_.rows; ++row) {
        for (int column = 0; column < geometry_.columns; ++column) {
            const double z = bed.at(column, row);
            if (std::isnan(z)) continue;
            bed_[index(column, row)] = rounded(z - lowest);
            unknown_[index(column, row)] = 0;
        }
    }
    // Unknown ground beside known ground continues its slope, so that debris leaves as if it went on.
    std::vector<std::uint8_t> filled(unknown_.size());
    std::transform(unknown_.begin(), unknown_.end(), filled.begin(), [](std::uint8_t u) { return u ? 0 : 1; });
    for (int ring = 0; ring < margin; ++ring) {
        std::vector<std::pair<std::size_t, float>> found;
        for (int row = -margin; row < geometry_.rows + margin; ++row) {
            for (int column = -margin; column < geometry_.columns + margin; ++column) {
                const std::size_t i = index(column, row);
                if (filled[i]) continue;
                double sum = 0, flat_sum = 0;
                int count = 0, flat_count = 0;
                for (int dy = -1; dy <= 1; ++dy) {
                    for (int dx = -1; dx <= 1; ++dx) {
                        const auto beside = [&](int steps) { return index(column + steps * dx, row + steps * dy); };
                        const auto inside = [&](int steps) {
                            const int c = column + steps * dx, r = row + steps * dy;
                            return c >= -margin && r >= -margin && c < geometry_.columns + margin &&
                                   r < geometry_.rows + margin && filled[beside(steps)];
                        };
                        if ((dx == 0 && dy == 0) || !inside(1)) continue;
                        if (inside(2)) {
                            sum += 2 * bed_[beside(1)] - bed_[beside(2)];
                            ++count;
                        } else {
                            flat_sum += bed_[beside(1)];
                            ++flat_count;
                        }
                    }
                }
                if (count + flat_count == 0) continue;
                const double z = count > 0 ? sum / count : flat_sum / flat_count;
                found.emplace_back(i, rounded(z));
            }
        }
        for (const auto& [i, z] : found) {
            bed_[i] = z;
            filled[i] = 1;
        }
    }
    if (edges_ == Edges::continued) {
        for_each_continued_row([&](std::size_t to, std::size_t from) {
            std::copy_n(bed_.begin() + static_cast<std::ptrdiff_t>(from), stride_,
                        bed_.begin() + static_cast<std::ptrdiff_t>(to));
        });
    }
    for (int row = -margin; row < geometry_.rows + margin; ++row) {
        for (int column = -margin; column < geometry_.columns + margin; ++column) {
            const std::size_t i = index(column, row);
            if (unknown_[i]) has_unknown_[tile_of(column, row)] = 1;
            find_slopes(i);
        }
    }
}

/// Over two cells; beside a structure that of the open side, as debris sees it.
void Solver::find_slopes(std::size_t cell) {
    const auto over_two = [&](std::size_t step) {
        const auto rise = [&](std::size_t to, std::size_t from) -> std::optional<float> {
            const bool walled = !structure_.empty() && structure_[to] != structure_[from];
            return walled ? std::nullopt : std::optional(bed_[to] - bed_[from]);
        };
        const auto below = rise(cell, cell - step), above = rise(cell + step, cell);
        return below && above ? *below + *above : 2 * below.value_or(above.value_or(0));
    };
    const auto half_cell = static_cast<float>(0.5 / geometry_.cell);
    slope_x_[cell] = over_two(1) * half_cell;
    slope_y_[cell] = over_two(stride_) * half_cell;
}

/// Calls f with the first index of a row of the margin and of the row that it repeats.
template <class F>
void Solver::for_each_continued_row(const F& f) const {
    for (int k = 1; k <= margin; ++k) {
        f(index(-margin, -k), index(-margin, 0));
        f(index(-margin, geometry_.rows - 1 + k), index(-margin, geometry_.rows - 1));
    }
}

void Solver::continue_rows(const Motion& motion) const {
    for_each_continued_row([&](std::size_t to, std::size_t from) {
        for (float* array : {motion.depth, motion.u, motion.v, motion.spare, motion.pore_pressure,
                             motion.solid_fraction, motion.height, motion.climb}) {
            if (array == nullptr) continue;
            std::copy_n(array + (from - origin_), stride_, array + (to - origin_));
        }
    });
}

void Solver::set_cover(const GroundValues& ground) {
    const auto pad = [&](const std::vector<float>& values, std::vector<float>& to, double scale) {
        if (values.empty()) return;
        to.assign(depth_.size(), std::numeric_limits<float>::quiet_NaN());
        for (int row = 0; row < geometry_.rows; ++row) {
            for (int column = 0; column < geometry_.columns; ++column) {
                to[index(column, row)] = static_cast<float>(values[geometry_.index(column, row)] * scale);
            }
        }
    };
    pad(ground.friction_coefficient, friction_, 1);
    pad(ground.inverse_turbulent_friction, inverse_turbulence_, 1);
    pad(ground.cohesion, strength_, 1 / material_.rest_density);
    pad(ground.stem_drag, stem_drag_, 1);
    pad(ground.laminar_viscosity, viscosity_, 1);
    pad(ground.structure, structure_, 1);
    for (float& s : structure_) s = std::isnan(s) ? 0 : s;
    if (!structure_.empty()) near_structure_.assign(changed_.size(), 0);
    for (int row = 0; row < geometry_.rows && !structure_.empty(); ++row) {
        for (int column = 0; column < geometry_.columns; ++column) {
            if (structure_[index(column, row)] == 0) continue;
            const int tile_row = (row + margin) / tile_edge, tile = (column + margin) / tile_edge;
            for (int r = std::max(0, tile_row - 1); r <= std::min(tile_rows_ - 1, tile_row + 1); ++r) {
                const auto first = static_cast<std::size_t>(r) * static_cast<std::size_t>(tile_columns_);
                for (int c = std::max(0, tile - 1); c <= std::min(tile_columns_ - 1, tile + 1); ++c) {
                    near_structure_[first + static_cast<std::size_t>(c)] = 1;
                }
            }
        }
    }
}

double Solver::erode(int column, int row, double depth) {
    const double eroded = std::floor(depth / elevation_spacing_) * elevation_spacing_;
    const std::size_t i = index(column, row);
    if (unknown_[i] || !(eroded > 0)) return 0;
    bed_[i] -= static_cast<float>(eroded);
    for (int k = 1; edges_ == Edges::continued && k <= margin; ++k) {
        if (row == 0) bed_[index(column, -k)] = bed_[i];
        if (row == geometry_.rows - 1) bed_[index(column, row + k)] = bed_[i];
    }
    for (const std::size_t at : {i, i - 1, i + 1, i - stride_, i + stride_}) find_slopes(at);
    inject(column, row, eroded, 0, 0);
    return eroded;
}

}  // namespace talus::depth
