#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/geometry.hpp"
#include "terrain/buildings.hpp"
#include "terrain/plan_bins.hpp"
#include "terrain/terrain.hpp"

namespace talus::observe {

/// The walls and roofs of structures, divided into patches of a reference area, independent of the particles. A wall is
/// divided along into equal columns no narrower than the area's edge, a column upward from the ground into equal
/// patches no lower than that. A wall smaller than the edge counts with the edge: it does not reduce the reference
/// area.
class WallPatches {
  public:
    /// A column of a wall, or a strip of a roof, local.
    struct Column {
        double x, y, z;           ///< lower end of the edge where the column begins
        double along_x, along_y;  ///< unit, horizontal
        double from, length;      ///< of the wall before the column, and of the whole wall
        double width, row_height;
        double area;  ///< m2, of a patch
        std::int32_t rows;
        std::int32_t building;
        std::uint32_t first_patch;  ///< of the building's
        bool roof;                  ///< its rows are adjacent in plan

        /// Distance along, up (or across, on a roof), and out of the solid.
        struct Place {
            double along, up, out;
        };
        [[nodiscard]] Place place_of(const LocalPoint& p) const {
            const double dx = p.x - x, dy = p.y - y, dz = p.z - z;
            const double along = dx * along_x + dy * along_y, right = dx * along_y - dy * along_x;
            return roof ? Place{along, -right, dz} : Place{along, dz, right};
        }
    };

    WallPatches() = default;
    /// `edge`: of the reference area, m. `reach`: distance from a wall, in plan, within which it is found, m.
    WallPatches(const terrain::Terrain& terrain, const std::vector<terrain::Building>& buildings, double edge,
                double reach);

    [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
    [[nodiscard]] std::uint32_t patches_of(std::size_t building) const { return patches_[building]; }

    /// Columns within reach of a local plan position, and some more.
    [[nodiscard]] std::span<const std::uint32_t> near(double x, double y) const { return bins_.near(x, y); }
    [[nodiscard]] const terrain::PlanBins& bins() const { return bins_; }

    /// Calls f(patch, share / m2) for the patches of a building that are covered by a square of edge `size` centred at
    /// `at`. The part beyond the wall's end, foot or top is folded back, so that the shares add up to 1 and a uniform
    /// load stays uniform.
    template <class F>
    void spread(std::int32_t building, const LocalPoint& at, double size, const F& f) const;

    /// Length of [middle - size / 2, middle + size / 2] within [0, end].
    [[nodiscard]] static double overlap(double middle, double size, double end) {
        const double from = middle - size / 2, to = middle + size / 2;
        return std::max(0.0, (to < end ? to : end) - (from > 0 ? from : 0));
    }

    /// The same for a strip [from, from + width] and a square folded back at 0 and `length`.
    [[nodiscard]] static double folded_overlap(double middle, double size, double length, double from, double width) {
        return overlap(middle - from, size, width) + overlap(-middle - from, size, width) +
               overlap(2 * length - middle - from, size, width);
    }

    template <class Archive>
    void keep(Archive& archive) {
        archive(edge_, columns_, patches_, bins_);
    }

  private:
    void add_walls(const terrain::Terrain& terrain, const terrain::Building& of, const Ring& ring, bool hole,
                   double clearance, double roof, int building);
    void add_roof(const terrain::Terrain& terrain, const Polygon& part, double roof, int building);
    void add_column(Column column, double height);
    void fill_bins(double reach);

    double edge_ = 1;
    std::vector<Column> columns_;
    std::vector<std::uint32_t> patches_;  // by building, how many
    terrain::PlanBins bins_;              // of columns_
};

template <class F>
void WallPatches::spread(std::int32_t building, const LocalPoint& at, double size, const F& f) const {
    constexpr double same_plane = 0.01;  // m
    // It touches the nearest walls: two at a corner.
    double nearest = std::numeric_limits<double>::infinity(), whole = 0;
    const auto for_each = [&](const auto& g) {
        for (const std::uint32_t index : near(at.x, at.y)) {
            const Column& column = columns_[index];
            if (column.building != building) continue;
            const Column::Place place = column.place_of(at);
            if (std::abs(place.out) > nearest + same_plane) continue;
            const double along =
                folded_overlap(column.from + place.along, size, column.length, column.from, column.width);
            if (!(along > 0)) continue;
            const double height = column.rows * column.row_height;
            const double up = folded_overlap(place.up, size, height, 0, height);
            if (up > 0) g(column, place, along, up);
        }
    };
    for_each([&](const Column&, const Column::Place& place, double, double) {
        nearest = std::min(nearest, std::abs(place.out));
    });
    for_each([&](const Column&, const Column::Place&, double along, double up) { whole += along * up; });
    for_each([&](const Column& column, const Column::Place& place, double along, double) {
        const double scale = along / (whole * column.area);
        const double height = column.rows * column.row_height;
        // No row is covered beyond those, nor by what is folded back at foot or top.
        const double low = std::min(place.up, 2 * height - place.up) - size / 2;
        const double high = std::max(place.up, -place.up) + size / 2;
        const double rows = column.rows;
        const auto first = static_cast<std::int32_t>(std::clamp(low / column.row_height - 1, 0.0, rows));
        const auto last = static_cast<std::int32_t>(std::clamp(high / column.row_height + 2, 0.0, rows));
        for (std::int32_t row = first; row < last; ++row) {
            const double up = folded_overlap(place.up, size, height, row * column.row_height, column.row_height);
            if (up > 0) f(column.first_patch + static_cast<std::uint32_t>(row), up * scale);
        }
    });
}

}  // namespace talus::observe
