#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry.hpp"
#include "core/number.hpp"
#include "params/spec.hpp"

/// Water that rises in a release until its debris fails (docs/pore-pressure.md).
namespace talus::sim {

struct Model;
struct StateSummary;

/// Of particles: the sum of their positions, and how many there are.
struct PlaceSum {
    double x = 0, y = 0, z = 0;  ///< m, local
    std::uint32_t count = 0;

    [[nodiscard]] TALUS_DEVICE static PlaceSum of(const LocalPoint& p) {
        return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z), 1};
    }
    [[nodiscard]] Vec3<double> mean() const { return Vec3<double>{x, y, z} * (1.0 / count); }
    friend TALUS_DEVICE PlaceSum operator+(const PlaceSum& a, const PlaceSum& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z, a.count + b.count};
    }
};

/// The water of a release in a step. Without padding, since it is saved as it is.
struct Water {
    Vec3<double> start;    ///< m, local, the mean place of its particles when they were let go
    double failed_at = 0;  ///< s, if it has failed
    float ratio = -1;      ///< lambda or r_u that it gives the debris at the end of the step, and once that has failed
                           ///< the last one; negative: no water rises
    float rise = 0;        ///< of the ratio in the step
    std::uint32_t started = 0, failed = 0;  ///< 1: its particles were let go; have failed

    /// Whether it decides the pore pressure.
    [[nodiscard]] TALUS_DEVICE bool rises() const { return ratio >= 0 && failed == 0; }
};

/// The water of the release that a particle belongs to.
template <class AnyModel, class Waters>
[[nodiscard]] TALUS_DEVICE Water water_of(const AnyModel& model, const Waters& water_of_release, std::size_t id) {
    for (std::size_t r = 0; r < water_of_release.size() && r < model.releases.size(); ++r) {
        if (id >= model.releases[r].first_particle && id < model.releases[r].last_particle) return water_of_release[r];
    }
    return {};
}

/// The ratio at a time: linear between rows, that of the first or last row outside them.
[[nodiscard]] double ratio_at(const std::vector<params::PressureSample>& rows, double time);

/// Whether water rises in any release.
[[nodiscard]] bool has_rising_water(const Model& model);

/// Whether some of it still changes, in a release that has not failed.
[[nodiscard]] bool water_to_come(const Model& model, const StateSummary& state);

/// Brings the water of every release to the end of a step that begins. A release has failed once its particles have
/// moved by more than their spacing in the mean. `places`: of the particles with an id from the first number on and
/// below the second.
void raise_water(const Model& model, StateSummary& state,
                 const std::function<PlaceSum(std::uint32_t, std::uint32_t)>& places);

}  // namespace talus::sim
