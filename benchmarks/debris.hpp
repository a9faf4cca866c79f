#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/scenes.hpp"
#include "sim/cpu/cell_sort.hpp"
#include "sim/cpu/neighbours.hpp"
#include "sim/cpu/stages.hpp"
#include "sim/cpu/work.hpp"
#include "sim/simulation.hpp"
#include "sim/step_constants.hpp"

namespace talus::benchmarks {

/// The bench scene `slab` after some steps. Created once per number of particles, since that takes longer than
/// measuring.
struct Debris {
    explicit Debris(int particles);

    [[nodiscard]] const sim::Model& model() const { return simulation.model(); }
    [[nodiscard]] const sim::Ground& ground() const { return simulation.ground(); }
    [[nodiscard]] const sim::State& state() const { return simulation.state(); }

    bench::Start start;
    sim::Simulation simulation;
};
[[nodiscard]] const Debris& debris_of(std::int64_t particles);

/// A stage of a step that is compiled per instruction set; it works on blocks.
struct Stage {
    std::string name;
    std::function<void(const sim::cpu::StageData&, std::size_t first, std::size_t last)> run;
};

/// The stages of a step with one iteration, in order, before and after the neighbour search.
struct Stages {
    explicit Stages(const sim::Model& model);

    Stage predict;
    std::vector<Stage> after_neighbours;
};

/// A step in progress: the data of the stages, as in the backend.
class Step {
  public:
    Step(const Debris& debris, params::InternalFriction method);

    /// Runs the stages before the one at this index in Stages::after_neighbours.
    void run_until(std::size_t place);
    void run(const Stage& stage);

    /// Saves the data that stages read and change, and restores it: a stage that is run repeatedly would move far from
    /// the initial state of a step.
    void remember();
    void restore();

    [[nodiscard]] const Stages& stages() const { return stages_; }
    [[nodiscard]] std::uint32_t count() const { return state_.count; }

  private:
    void find_neighbours();

    sim::Model model_;
    sim::Ground ground_;
    sim::State state_;
    sim::StepConstants constants_;
    sim::cpu::Work work_;
    sim::cpu::NeighbourLists neighbours_;
    Stages stages_;
    struct Memory {
        std::vector<sim::cpu::DisplacedRow> displaced;
        std::vector<sim::cpu::MotionRow> motion;
        sim::VectorArray position, velocity, shift, contact_friction, corrected, end;
        sim::DeviatorArray stress;
        std::vector<float> multiplier, contact_normal, still_time;
    };
    Memory memory_;
};

}  // namespace talus::benchmarks
