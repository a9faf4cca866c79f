#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/phases.hpp"
#include "observe/observation.hpp"
#include "run/fault_record.hpp"
#include "run/zoom_record.hpp"
#include "sim/stage_times.hpp"

namespace talus::run {

enum class RunPhase {
    ready,    ///< advance() would take a step
    at_rest,  ///< debris came to rest, or none remains; a change makes it ready again
    ended,    ///< solver.end_time is reached
    fault,    ///< the last step cannot be trusted
};

enum class RunStatus { complete, interrupted, fault };

/// What was not at rest at the end of a run: faster than outputs.deposited_speed.
struct StillMoving {
    double volume = 0;          ///< m3
    double share = 0;           ///< of the debris that was let go, also of what left the terrain
    double greatest_speed = 0;  ///< m/s
    /// s, since when the kinetic energy had been below a hundredth of its peak, where other programs end; NaN: it was
    /// not.
    double slow_since = observe::never;
};
[[nodiscard]] StillMoving still_moving(const std::vector<observe::TimeSample>& timeseries,
                                       const observe::TimeSample& end);
/// A reason for which a run ended, and what still moved: "reached ... with 12.6 m3 still moving (...)".
[[nodiscard]] std::string with_what_moved(std::string reason, const StillMoving& moving);

/// When a release failed in which water rises (sim/rising_water.hpp).
struct Initiation {
    std::string release;
    double failed_at = observe::never;  ///< s; NaN: it did not fail
    double ratio = observe::never;      ///< pore-pressure ratio of the water then, or at the end; NaN: it did not start
};

struct RunResult {
    RunStatus status = RunStatus::complete;
    std::string stop_reason;           ///< "debris came to rest (less than 0.1 % of it moving for 3 s)", the fault, ...
    std::optional<FaultRecord> fault;  ///< at fault
    observe::Observation observation;
    std::vector<Initiation> initiations;  ///< of the releases in which water rises
    sim::StageTimes stage_times;          ///< of particles
    std::vector<Phase> grid_stages;       ///< of the depth-averaged model
    std::uint64_t hash = 0;               ///< of time, ids, positions and velocities at the end, in id order
    std::uint32_t particles = 0;          ///< from releases and inflows, without removed or entrained ones
    std::uint64_t steps = 0;
    double simulated_time = 0, wall_time = 0;  ///< s; wall time of the model's steps, with a grid without measurements
    double seed_time = 0, finish_time = 0;     ///< s of wall time: before the first step, and after the last one
    double smallest_time_step = 0, largest_time_step = 0;
    double particle_spacing = 0, support_radius = 0, map_cell = 0;
    double viscosity = 0, kinematic_viscosity = 0;  ///< smoothing per 1/60 s; its equivalent in m2/s
    int thread_count = 0;
    std::string backend = "cpu";  ///< what moved the particles, as solver.backend names it
    std::string instruction_set;  ///< used for the sums over neighbours, or the cells; with a card, its name

    // Of the depth-averaged model: no particles then.
    double grid_cell = 0;            ///< m; 0: particles
    std::uint64_t grid_cells = 0;    ///< of the grid
    std::uint64_t cell_updates = 0;  ///< by all steps

    std::optional<ZoomRecord> zoom;  ///< particles were run in one area only: all results are of that

    [[nodiscard]] StillMoving still_moving() const {
        const auto& rows = observation.timeseries;
        return rows.empty() ? StillMoving{} : run::still_moving(rows, rows.back());
    }
    /// Whether a place lies in what was computed.
    [[nodiscard]] bool covers(const PlanPoint& at) const { return !zoom || contains(zoom->area, at); }
    /// That, in a word.
    [[nodiscard]] const char* domain() const { return zoom ? "zoom" : "terrain"; }
    [[nodiscard]] bool depth_averaged() const { return grid_cell > 0; }
    /// s of wall time that all steps took, with their measurements.
    [[nodiscard]] double step_time() const {
        if (!depth_averaged()) return wall_time;
        double sum = 0;
        for (const Phase& stage : grid_stages) sum += stage.seconds;
        return sum;
    }
    [[nodiscard]] double real_time_factor() const { return wall_time > 0 ? simulated_time / wall_time : 0; }
};

}  // namespace talus::run
