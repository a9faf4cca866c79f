#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

namespace talus::sim {

// clang-format off
/// All that happens in a step, in order: X(name, short name for tables, what it does). The enumeration, the timings and
/// the table in docs/tour.md follow from this list; step.hpp runs it.
#define TALUS_STEP_STAGES(X)                                                                                           \
    X(inject_inflow, "inflow", "adds the particles of inflows, and guides the newest rows")                            \
    X(choose_time_step, "dt", "the longest time step in which nothing moves too far")                                  \
    X(release_held, "release", "releases the debris whose start time is reached")                                      \
    X(apply_drag, "drag", "flow thickness from the particles per column; drag that grows with speed")                  \
    X(predict_positions, "predict", "gravity, and the predicted position of each particle")                            \
    X(sort_particles, "sort", "sorts by cell; cost follows the particles, not the bounding box")                       \
    X(find_neighbours, "neighbours",                                                                                   \
      "lists pairs within support radius; sleeping debris is sorted last, so that stages skip it")                     \
    X(prepare_particles, "prepare", "displacements of the step, empty contacts, how the ground holds each particle")   \
    X(warm_start, "warm start", "density constraints, ground, walls; starts from the last step's pressure and stress") \
    X(solve_density, "density", "an iteration: corrects density, resists shear within internal friction")              \
    X(solve_contacts, "contacts", "in the same iteration: ground and walls push back, with Coulomb friction")          \
    X(measure_compression, "compression", "compression of the debris after the iterations")                            \
    X(resolve_penetration, "overlaps",                                                                                       \
      "moves particles apart that are still too dense or too close to the ground, without adding velocity")            \
    X(enforce_boundaries, "bounds",                                                                                    \
      "the swept test: no particle ends below ground or inside a building, at any speed")                              \
    X(update_velocities, "velocities", "velocity is displacement over time step")                                      \
    X(measure_impacts, "impacts", "the impulses on walls and roofs")                                                   \
    X(apply_viscosity, "viscosity", "neighbours' velocities approach each other")                                      \
    X(update_sleep, "sleep",                                                                                           \
      "puts to sleep particles that have hardly moved for the rest duration, wakes those with moving neighbours")      \
    X(remove_outflow, "outflow", "counts and removes particles beyond the edge of the terrain")                        \
    X(check_faults, "check", "ends the run if the step cannot be trusted")                                             \
    X(entrain_bed, "entrain", "entrainment of the bed: ground becomes particles")                                     \
    X(observe, "observe", "the observers read the state: peaks see every step")                                        \
    X(remove_failed, "failed", "removes structures whose resistance was exceeded, wakes the debris they held")
// clang-format on

/// The stages of a step, in order.
enum class Stage {
#define TALUS_STAGE_ENTRY(name, short_name, what) name,
    TALUS_STEP_STAGES(TALUS_STAGE_ENTRY)
#undef TALUS_STAGE_ENTRY
};

struct StageDescription {
    std::string_view name, short_name, what;
};
inline constexpr std::array step_stages = {
#define TALUS_STAGE_ENTRY(name, short_name, what) StageDescription{#name, short_name, what},
    TALUS_STEP_STAGES(TALUS_STAGE_ENTRY)
#undef TALUS_STAGE_ENTRY
};
inline constexpr std::size_t stage_count = step_stages.size();

/// Wall seconds spent per stage since the start.
struct StageTimes {
    std::array<double, stage_count> seconds{};
};

/// Adds the time from construction to destruction to a stage.
class StageTimer {
  public:
    StageTimer(StageTimes& times, Stage stage) : times_(times), stage_(stage) {}
    ~StageTimer() {
        const auto elapsed = std::chrono::steady_clock::now() - start_;
        times_.seconds[static_cast<std::size_t>(stage_)] += std::chrono::duration<double>(elapsed).count();
    }
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

  private:
    StageTimes& times_;
    Stage stage_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace talus::sim
