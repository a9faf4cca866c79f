#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "observe/observation.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// What one run says of a barrier, or of the place where it is to stand.
namespace talus::design {

/// A line on which a barrier is to stand.
struct SiteLine {
    std::string name;
    std::vector<PlanPoint> points;  ///< world
};

/// Names of the cross-sections along a line and beyond its ends, which runs of a design have.
inline constexpr const char* line_section = "design: line";
inline constexpr const char* left_section = "design: beyond its first point";
inline constexpr const char* right_section = "design: beyond its last point";

/// Replaces the barrier of that name by one on `line`, `height` m above the ground; `height` 0: leaves it out. Adds the
/// cross-sections. Errors: no such barrier; as make_barrier; it stands on a release.
[[nodiscard]] Status place_barrier(scene::Scene& scene, const std::string& barrier, const SiteLine& line,
                                   double height);

struct BarrierRun {
    double released = 0;                                ///< m3
    double over = 0;                                    ///< m3 over the crest and not back
    double through = 0;                                 ///< m3 through openings and meshes
    double around = 0;                                  ///< m3 round the ends, within the cross-sections there
    double crossed = 0;                                 ///< m3 along and beside the line, without the barrier
    double first_over = observe::never;                 ///< s
    double retained = 0;                                ///< m3 at most
    double filling = 0;                                 ///< m, mean depth along the face at most
    double run_up = 0;                                  ///< m, deepest at the face
    double force = 0;                                   ///< N, the peak
    double pressure = 0;                                ///< Pa, the peak, of a patch
    double speed = 0;                                   ///< m/s, of the undisturbed flow: the greatest along the line
    double depth = 0;                                   ///< m, likewise
    double peak_discharge = 0;                          ///< m3/s, likewise
    std::vector<observe::StructureSample> history{};    ///< with a barrier
    std::vector<observe::DischargeSample> discharge{};  ///< without

    [[nodiscard]] double passing() const { return over + through + around; }
    /// Whether debris passes: more than a thousandth of what was released.
    [[nodiscard]] bool passes() const { return passing() > 1e-3 * released; }
};

/// With a barrier of that name, or without any.
[[nodiscard]] BarrierRun barrier_run(const run::RunResult& result, const std::string& barrier, const SiteLine& line,
                                     double arrival_depth);

/// Writes and reads it, with a checksum. Errors: cannot be written; missing, damaged.
[[nodiscard]] Status write_barrier_run(const std::filesystem::path& file, const BarrierRun& run);
[[nodiscard]] Result<BarrierRun> read_barrier_run(const std::filesystem::path& file);

}  // namespace talus::design
