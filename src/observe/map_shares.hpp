#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/geometry.hpp"
#include "core/number.hpp"
#include "observe/map_units.hpp"

/// How particles count on a map, and what its cells keep: for the lanes of the processor and for a device.
namespace talus::observe {

inline constexpr unsigned map_tile_size = 8;  ///< cells along the edge of a tile
inline constexpr std::size_t map_tile_cells = std::size_t{map_tile_size} * map_tile_size;

inline constexpr float map_weight = 1 << 12;  ///< a weight of 1 along one axis
static_assert(map_weight * map_weight == map_units::particle);
inline constexpr float map_fastest = 1000;  ///< m/s; with up to 500 particles per cell, even of a faulty state, the
                                            ///< sums are exact

/// Where the cells of a map lie.
struct MapFrame {
    float x_offset = 0, y_offset = 0;  ///< m, of the particles' origin from the map's corner
    float inverse_cell = 0;            ///< 1/m
    int columns = 0, rows = 0;
};

/// Whole-number weights of the cells before, at and after a particle's along one axis: a quadratic B-spline. Shares
/// beyond the map's edge stay in its outermost cell.
template <class Real, class Index>
struct AxisShare {
    Index cell{};
    Real before{}, at{}, after{};
};

/// `x` of a particle; `offset`, `inverse_cell` and `cells` of the map.
template <class Real>
TALUS_INLINE auto axis_share(const Real& x, float offset, float inverse_cell, int cells) {
    const Real u = (x + Real(offset)) * Real(inverse_cell);
    const Real last_cell(cells - 1), inside = larger(Real(0), smaller(Real(cells), u));
    const auto whole = truncated(smaller(last_cell, inside));
    const Real here = from_index<Real>(whole);
    const Real low = inside - here, high = Real(1) - low;  // shares of the cell on either side
    const Real half(map_weight / 2);
    const Real after = select(here < last_cell, from_index<Real>(truncated(half * low * low)), Real(0));
    const Real before = select(here > Real(0), from_index<Real>(truncated(half * high * high)), Real(0));
    return AxisShare<Real, decltype(truncated(Real(0)))>{whole, before, Real(map_weight) - before - after, after};
}

/// In units of the map.
template <class Real>
TALUS_INLINE Real whole_speed(const Real& vx, const Real& vy, const Real& vz) {
    using std::sqrt;
    const Real speed = sqrt(vx * vx + vy * vy + vz * vz);
    const Real limited = select(speed < Real(map_fastest), speed, Real(map_fastest));
    return from_index<Real>(truncated(limited * Real(map_units::speed) + Real(0.5)));
}

/// kg/m3, of a particle; `own` 0: the rest density.
TALUS_DEVICE inline float whole_density(float own, double rest_density) {
    return std::round(own > 0 ? own : static_cast<float>(rest_density));
}

/// What the sums of a cell mean.
struct MapScale {
    double depth_of_unit = 0;                      ///< m
    double thinnest_depth = 0, arrival_depth = 0;  ///< m
    double rest_density = 0;                       ///< kg/m3
    bool keeps_pressures = false;                  ///< peak pressures do not follow from peak speeds
};

/// The sums of a cell: 2^-24 of a particle, and the same times 2^-10 m/s or 1 kg/m3.
struct MapSum {
    double volume = 0, weighted = 0;

    [[nodiscard]] TALUS_DEVICE double speed() const {
        return weighted / volume / static_cast<double>(map_units::speed);
    }
    /// kg/m3, of sums weighed by densities.
    [[nodiscard]] TALUS_DEVICE float density(const MapScale& scale) const {
        return static_cast<float>(volume > 0 ? weighted / volume : scale.rest_density);
    }
};

/// What a map keeps by cell, in one array each.
template <class Array>
struct MapArrays {
    Array depth{}, speed{};                 ///< peaks, of the depth-averaged speed; depth 0: not reached
    Array arrival_time{}, arrival_speed{};  ///< NaN: never; depth-averaged
    Array pressure{};                       ///< peak, Pa; only where the density has changed
};
using MapCell = MapArrays<float&>;

template <class Make>
[[nodiscard]] auto made_map_arrays(const Make& make) {
    return MapArrays<decltype(make())>{make(), make(), make(), make(), make()};
}
/// f(array, the same of the others...) for every array.
template <class F, class... Arrays>
void for_each_map_array(const F& f, Arrays&... all) {
    f(all.depth...);
    f(all.speed...);
    f(all.arrival_time...);
    f(all.arrival_speed...);
    f(all.pressure...);
}
template <class Arrays>
[[nodiscard]] TALUS_DEVICE MapCell map_cell(Arrays& arrays, std::size_t k) {
    return {arrays.depth[k], arrays.speed[k], arrays.arrival_time[k], arrays.arrival_speed[k], arrays.pressure[k]};
}
TALUS_DEVICE inline void clear_cell(const MapCell& cell) {
    cell.depth = cell.speed = cell.arrival_speed = cell.pressure = 0;
    cell.arrival_time = std::numeric_limits<float>::quiet_NaN();
}

/// Gives cell `k` of the maps what it keeps at `at`; `pressure`, Pa, and `present`, m: the peak so far, and the depth
/// now.
template <class Arrays, class Maps>
void read_cell(const Arrays& from, std::size_t at, float pressure, float present, Maps& maps, std::size_t k) {
    maps.peak_depth.values[k] = from.depth[at];
    maps.peak_speed.values[k] = from.speed[at];
    maps.peak_pressure.values[k] = pressure;
    maps.arrival_time.values[k] = from.arrival_time[at];
    if (!std::isnan(from.arrival_time[at])) maps.arrival_speed.values[k] = from.arrival_speed[at];
    maps.deposit_depth.values[k] = present;
}

/// Peaks and arrival after a step at `time`.
TALUS_DEVICE inline void update_cell(const MapScale& scale, const MapSum& sum, double density, double time,
                                     const MapCell& cell) {
    const double now = sum.volume * scale.depth_of_unit;
    if (now < scale.thinnest_depth) return;
    if (sum.weighted > sum.volume * static_cast<double>(cell.speed) * static_cast<double>(map_units::speed)) {
        cell.speed = static_cast<float>(sum.speed());
    }
    if (scale.keeps_pressures) {
        const double speed = sum.speed();
        const auto pressure = static_cast<float>(density * speed * speed);
        cell.pressure = cell.pressure < pressure ? pressure : cell.pressure;
    }
    // Debris arrives with a depth that the cell never had before.
    if (now > static_cast<double>(cell.depth)) {
        cell.depth = static_cast<float>(now);
        if (now > scale.arrival_depth && cell.arrival_time != cell.arrival_time) {
            cell.arrival_time = static_cast<float>(time);
            cell.arrival_speed = static_cast<float>(sum.speed());
        }
    }
}

}  // namespace talus::observe
