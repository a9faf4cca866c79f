#pragma once

#include <functional>
#include <vector>

#include "depth/solver.hpp"
#include "params/spec.hpp"
#include "sim/simulation.hpp"

/// When a run will be over, from the motion of its debris and the ground ahead of it.
namespace talus::run {

/// A sample of the debris, which slides on alone.
struct SlidingBlock {
    Vec3<double> position, velocity;  ///< local, m, m/s
    double thickness = 0;             ///< m, of the flow around it, for the drag
    double start = 0;                 ///< s, from now; held until then
};

/// When each block is last faster than outputs.deposited_speed, s from now, in ascending order; at most `horizon`. Each
/// slides on the run's ground with the run's friction and drag (Voellmy 1955), as the mass-point models of avalanches
/// do, until it stops, meets a structure or leaves the terrain. That debris is held and pushed by its neighbours is
/// left out.
[[nodiscard]] std::vector<double> stop_times(const sim::Model& model, const sim::Ground& ground,
                                             std::vector<SlidingBlock> blocks, double deposited_speed, double horizon);

/// What of the debris still moves, and for how long it would if it slid on alone.
struct Outlook {
    double coasting = 0;      ///< s, until less of it moves than the stop rule allows
    double half_stopped = 0;  ///< s, until half of what is awake has stopped
    double moving_share = 0;  ///< faster than outputs.deposited_speed, of the debris
    double enough_share = 0;  ///< so much of it must move for the run to go on
    double awake_share = 1;   ///< of the debris
    double cost_asleep = 1;   ///< of a step, with all debris asleep, over one with all of it awake
    double energy = 0;        ///< kinetic, in any unit
    double wait = 0;          ///< s, until the last inflow ends or, on the grid, the last release starts
};
[[nodiscard]] Outlook outlook_of(const sim::Simulation& simulation, double deposited_speed);
/// The same of the depth-averaged model. `model`, `ground`: of the same scene.
[[nodiscard]] Outlook outlook_of(const depth::Solver& solver, const sim::Model& model, const sim::Ground& ground,
                                 double deposited_speed);

/// Wall time left of a run. Its end is that of the stop rule, or solver.end_time. While all debris moves, it coasts to
/// a stop as blocks do that slide alone; where some of these stop much later than others, the ground holds debris up,
/// and it straggles for a while after that. Once a part has come to rest, the rest of it straggles, stopped and pushed
/// by what lies there, and the moving share falls about exponentially: the less moves, the more its trend counts. Where
/// energy or momentum ends the run, the trend of the energy may end it sooner. Wall
/// time starts from the pace of the latest steps, and follows the time step, which is longest at rest, and the debris
/// that is awake.
class RunClock {
  public:
    explicit RunClock(const params::SolverSpec& solver) : solver_(solver), end_(solver.end_time) {}

    /// After a step. Calls `look` now and then, for at most a fiftieth of the wall time; for more, a few times, where
    /// a run is short.
    void tick(double wall_time, double time, const std::function<Outlook()>& look);
    [[nodiscard]] double expected_end() const { return end_; }  ///< s, simulated
    /// s; NaN: too little is done to say.
    [[nodiscard]] double wall_remaining() const;
    [[nodiscard]] double share_done() const { return share_done_; }  ///< 0 to 1, never falls

  private:
    struct Mark {
        double wall_time = 0, time = 0, steps = 0, moving_share = 1, awake_share = 1, energy = 0;
    };
    /// What is left of the run, s of simulated time.
    struct Course {
        double coasting = 0, straggling = 0;
    };
    template <class Accepts>
    [[nodiscard]] Mark latest_mark(const Accepts& accepts) const;
    [[nodiscard]] Course course_after(const Outlook& now, double time) const;
    [[nodiscard]] double straggling(const Outlook& now, double time) const;
    [[nodiscard]] double declining(const Outlook& now, double time) const;
    [[nodiscard]] double wall_time_of(const Course& course, double wall_time, double time) const;

    params::SolverSpec solver_;
    std::vector<Mark> marks_;     ///< at every look
    Course course_;               ///< from course_from_ on
    double course_from_ = 0;      ///< s, simulated
    double longest_step_ = 1e-9;  ///< s, so far
    double cost_asleep_ = 1;
    double steps_ = 0, last_time_ = 0, next_look_ = 0, next_look_if_halfway_ = 0, end_, remaining_ = 0, share_done_ = 0;
};

}  // namespace talus::run
