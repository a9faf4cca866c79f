#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "observe/observation.hpp"
#include "params/spec.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"
#include "terrain/terrain.hpp"

/// What a run predicts for each kind of field observation, by one function each. NaN: the run gives no such value,
/// because debris did not reach the place.
namespace talus::ensemble {

/// m/s, mean speed of the debris at the front as it reached a chainage: what tilts the surface of a flow in a bend.
[[nodiscard]] double predict_debris_speed(const observe::Observation& run, double chainage);

/// s, at which it did.
[[nodiscard]] double predict_arrival_time(const observe::Observation& run, double chainage);

/// m, farthest chainage of the front.
[[nodiscard]] double predict_front_chainage(const observe::Observation& run);

inline constexpr double run_up_radius = 15;  ///< m, in which debris near a run-up mark counts

/// Height reached by debris above the ground at a place, m. Where debris did not reach it, the distance of the highest
/// debris within `search_radius` m below the place, as a negative number: a run that nearly reaches a mark on a bank is
/// better than one that stays in the bed.
[[nodiscard]] double predict_run_up(const observe::Observation& run, const terrain::Terrain& terrain,
                                    const PlanPoint& place, double search_radius = run_up_radius);

/// m, vertical deposit at a place; 0 where there is none.
[[nodiscard]] double predict_deposit_depth(const observe::Observation& run, const PlanPoint& place);

/// Pa, peak impact pressure on the building of that name; 0 if it was not hit, NaN if there is none.
[[nodiscard]] double predict_building_pressure(const observe::Observation& run, const std::string& building);

/// Area that both the outline and a map's cells of more than `depth` m cover, over the area that either does: 0 to 1
/// (Jaccard 1901).
[[nodiscard]] double predict_outline_overlap(const Grid<float>& map, const std::vector<Polygon>& outline, double depth);

/// Agreement of an observed change of elevation with computed deposit minus erosion, over the cells of the observed
/// one: 1 - sum |computed - observed| / sum (|computed| + |observed|), 0 to 1 (Bray & Curtis 1957). A change below
/// `detection_limit` m counts as none. Cells within a release are left out: what failed there left no deposit, and the
/// terrain may be that before or after.
[[nodiscard]] double predict_elevation_agreement(const observe::Observation& run, const Grid<float>& observed,
                                                 const std::vector<terrain::Release>& releases, double detection_limit);

/// m/s, the velocity derived from superelevated marks: v^2 = g R dh / (k b), the forced vortex with a correction factor
/// (Prochaska et al. 2008, Engineering Geology 97). The channel's slope is neglected.
[[nodiscard]] double superelevation_velocity(const params::SuperelevationSpec& marks);

/// A field observation as a number with its standard deviation.
struct ObservedValue {
    std::string key;   ///< "observation[0].front_velocity_mps", "damage[1].pressure_Pa"
    std::string name;  ///< "Front velocity at 121 m"
    std::string unit;
    double value = 0, uncertainty = 0;  ///< of damage: the limit of pressure
    /// Damage says only on which side of the value the prediction should lie.
    enum class Kind { equal, at_least, below } kind = Kind::equal;
    [[nodiscard]] const char* is() const {
        return std::array{"equal", "at_least", "below"}[static_cast<std::size_t>(kind)];
    }
    /// Substitute for the prediction of a run whose debris did not reach the place: front velocity and front chainage
    /// 0, arrival at the latest end of the run, run-up below the mark by the search radius.
    double unreached = 0;
    /// What a prediction can be: no speed, time, depth or pressure is below 0, no overlap above 1. The height of a
    /// run-up above the ground at its mark can be below 0.
    double least = 0, most = std::numeric_limits<double>::infinity();
};

/// All observations of a scene, in the order of its sections.
[[nodiscard]] std::vector<ObservedValue> observed_values(const scene::Scene& scene);

/// The predictions of a run for them, in the same order.
[[nodiscard]] std::vector<double> predicted_values(const scene::Scene& scene, const observe::Observation& run);

/// (predicted - observed) / uncertainty; of damage 0 on the right side of the limit. NaN where nothing is predicted.
[[nodiscard]] double deviation_of(const ObservedValue& observed, double predicted);

}  // namespace talus::ensemble
