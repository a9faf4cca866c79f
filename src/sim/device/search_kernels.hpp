#pragma once

#include <cstdint>
#include <limits>

#include "sim/device/views.hpp"

/// Sorting by cell, and the search for neighbours.
namespace talus::sim::device {

/// Where the particles will be, m.
struct Bounds {
    float x_min = std::numeric_limits<float>::max(), y_min = x_min, z_min = x_min;
    float x_max = std::numeric_limits<float>::lowest(), y_max = x_max, z_max = x_max;
};

struct BoundsOf {
    Data d;
    float time_step{};  ///< 0: where they are

    TALUS_DEVICE Bounds operator()(std::uint32_t i) const {
        const Vec3<float> p =
            d.state.moves(i) ? d.state.position[i] + d.state.velocity[i] * time_step : Vec3<float>(d.state.position[i]);
        return {p.x, p.y, p.z, p.x, p.y, p.z};
    }
};

struct JoinBounds {
    TALUS_DEVICE Bounds operator()(const Bounds& a, const Bounds& b) const {
        return {smaller(a.x_min, b.x_min), smaller(a.y_min, b.y_min), smaller(a.z_min, b.z_min),
                larger(a.x_max, b.x_max),  larger(a.y_max, b.y_max),  larger(a.z_max, b.z_max)};
    }
};

/// The cells of a padded box around all particles, in the order x, y, z; see cpu/cell_sort.hpp.
struct CellBox {
    double x_min = 0, y_min = 0, z_min = 0, inverse_cell = 0;
    std::uint64_t columns = 1, rows = 1, layers = 1;
    int key_bits = 0;  ///< of a cell; the next bit of a key is 1 for debris that sleeps, which is sorted last

    CellBox(const Bounds& box, double cell) : inverse_cell(1 / cell) {
        // One empty cell on each side: the key of a neighbour is then a plain sum that never wraps. The extra quarter
        // keeps rounding from placing the outermost particle in the padding.
        constexpr double padding = 1.25;
        x_min = box.x_min - padding * cell;
        y_min = box.y_min - padding * cell;
        z_min = box.z_min - padding * cell;
        const auto cells_along = [&](float low, float high) {
            return static_cast<std::uint64_t>((double(high) - low) * inverse_cell + padding) + 2;
        };
        columns = cells_along(box.x_min, box.x_max);
        rows = cells_along(box.y_min, box.y_max);
        layers = cells_along(box.z_min, box.z_max);
        while ((columns * rows * layers) >> key_bits != 0) ++key_bits;
    }
    [[nodiscard]] TALUS_DEVICE std::uint64_t cell_of(const Vec3<float>& p) const {
        const auto cx = static_cast<std::uint64_t>((p.x - x_min) * inverse_cell);
        const auto cy = static_cast<std::uint64_t>((p.y - y_min) * inverse_cell);
        const auto cz = static_cast<std::uint64_t>((p.z - z_min) * inverse_cell);
        return (cz * rows + cy) * columns + cx;
    }
};

struct CellKeys {
    Data d;
    CellBox box;
    float time_step{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const Bounds at = BoundsOf{d, time_step}(i);
        const auto sleeps = static_cast<std::uint64_t>(d.state.asleep[i] != 0);
        d.work.key[i] = box.cell_of({at.x_min, at.y_min, at.z_min}) | sleeps << box.key_bits;
        d.work.order[i] = i;
    }
};

/// to[i] = from[order[i]].
template <class T>
struct Gather {
    const T* from;
    T* to;
    const std::uint32_t* order;

    TALUS_DEVICE void operator()(std::uint32_t i) const { to[i] = from[order[i]]; }
};

/// 1 where the first particle of a cell is.
struct MarkFirst {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        d.work.index[i] = i == 0 || d.work.key[i] != d.work.key[i - 1] ? 1 : 0;
    }
};

inline constexpr int cell_row_count = 9;  ///< a cell's 27 neighbours are 9 rows of 3 cells with consecutive keys

/// Particles [first, last).
struct Range {
    std::uint32_t first = 0, last = 0;
};
/// The candidates around a cell.
struct CellRows {
    Range awake[cell_row_count], asleep[cell_row_count];
};

/// The occupied cells in the order of their keys.
struct Cells {
    std::uint64_t* key;
    std::uint32_t* start;  ///< first particle; one more at the end
    CellRows* rows;
    std::uint32_t count;
};

/// Lists the cells.
struct ListCells {
    Data d;
    Cells cells{};
    std::uint32_t particles{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const std::uint32_t cell = d.work.index[i];
        if (d.work.index[i + 1] > cell) {
            cells.key[cell] = d.work.key[i];
            cells.start[cell] = i;
        }
        if (i + 1 == particles) cells.start[cells.count] = particles;
    }
};

/// The particles in the rows around a cell.
struct FindRows {
    Cells cells{};
    CellBox box;
    bool any_asleep{};

    TALUS_DEVICE void operator()(std::uint32_t cell) const {
        const std::uint64_t key = cells.key[cell], sleeps = std::uint64_t{1} << box.key_bits;
        if ((key & sleeps) != 0) return;
        CellRows& rows = cells.rows[cell];
        for (int row = 0; row < cell_row_count; ++row) {
            const auto dy = static_cast<std::uint64_t>(row % 3) - 1, dz = static_cast<std::uint64_t>(row / 3) - 1;
            // Unsigned wrap-around is intended: padding makes every sum non-negative.
            const std::uint64_t low = key + (dz * box.rows + dy) * box.columns - 1;
            rows.awake[row] = range(low);
            rows.asleep[row] = any_asleep ? range(low | sleeps) : Range{};
        }
    }
    /// Of the cells from `low` to low + 2.
    [[nodiscard]] TALUS_DEVICE Range range(std::uint64_t low) const {
        std::uint32_t first = 0, after = cells.count;
        while (first < after) {
            const std::uint32_t middle = (first + after) / 2;
            if (cells.key[middle] < low) {
                first = middle + 1;
            } else {
                after = middle;
            }
        }
        std::uint32_t last = first;
        while (last < cells.count && cells.key[last] <= low + 2) ++last;
        return {cells.start[first], cells.start[last]};
    }
};

/// Calls f(j) for the neighbours of an awake particle, in a fixed order.
template <class F>
TALUS_DEVICE void search(const Data& d, const Cells& cells, float square_radius, std::uint32_t i, const F& f) {
    // `index` counts the cells up to a particle, so that its own is one less.
    const CellRows& rows = cells.rows[d.work.index[i + 1] - 1];
    const Vec3<float> p = d.work.place[i].vector();
    const auto look = [&](const Range& range) {
        for (std::uint32_t j = range.first; j < range.last; ++j) {
            const Vec3<float> separation = d.work.place[j].vector() - p;
            if (dot(separation, separation) < square_radius && j != i) f(j);
        }
    };
    for (const Range& range : rows.awake) look(range);
    for (const Range& range : rows.asleep) look(range);
}

struct CountNeighbours {
    Data d;
    Cells cells{};
    float square_radius{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t count = 0;
        search(d, cells, square_radius, i, [&](std::uint32_t) { ++count; });
        d.work.neighbour_count[i] = count;
    }
};

/// Room for the lists of the particles that are worked on together.
struct MeasureLists {
    Data d;
    std::uint32_t* size{};
    std::uint32_t awake{};

    TALUS_DEVICE void operator()(std::uint32_t group) const {
        std::uint32_t longest = 0;
        for (std::uint32_t i = group * list_width; i < (group + 1) * list_width && i < awake; ++i) {
            longest = d.work.neighbour_count[i] > longest ? d.work.neighbour_count[i] : longest;
        }
        size[group] = longest * list_width;
    }
};

struct WriteLists {
    Data d;
    Cells cells{};
    float square_radius{};
    std::uint32_t* neighbour{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        std::uint32_t* to = neighbour + d.neighbours.start[i / list_width] + i % list_width;
        search(d, cells, square_radius, i, [&](std::uint32_t j) {
            *to = j;
            to += list_width;
        });
    }
};

}  // namespace talus::sim::device
