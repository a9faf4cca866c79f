#include "debris.hpp"

#include <map>
#include <memory>
#include <span>

namespace talus::benchmarks {
namespace {

constexpr int steps = 20;  // until the initial lattice of the debris is disordered

sim::Model with_method(sim::Model model, params::InternalFriction method) {
    model.solver.internal_friction = method;
    return model;
}

}  // namespace

Debris::Debris(int particles)
    : start(*bench::make_start("slab", particles, "")), simulation(start.model, start.ground, start.state) {
    for (int step = 0; step < steps; ++step) (void)simulation.advance();
}

const Debris& debris_of(std::int64_t particles) {
    static std::map<std::int64_t, std::unique_ptr<Debris>> made;
    auto& debris = made[particles];
    if (!debris) debris = std::make_unique<Debris>(static_cast<int>(particles));
    return *debris;
}

Stages::Stages(const sim::Model& model) {
    const sim::cpu::ParticleStages particle = sim::cpu::particle_stages_for(model.kernel.choice);
    const Stage update_velocities = {"update_velocities", [update = particle.update_velocities](
                                                              const sim::cpu::StageData& data, std::size_t first,
                                                              std::size_t last) { (void)update(data, first, last); }};
    predict = {"predict", particle.predict};
    after_neighbours = {{"begin", particle.begin}};
    const auto add = [this](std::initializer_list<Stage> more) {
        after_neighbours.insert(after_neighbours.end(), more);
    };
    if (model.solver.internal_friction == params::InternalFriction::stress) {
        const sim::cpu::StressStages stress = sim::cpu::stress_stages_for(model.kernel.choice);
        add({{"linearise", stress.linearise},
             {"contacts", particle.contacts},
             {"solve", stress.solve},
             {"apply", stress.apply},
             {"find_spread", stress.find_spread},
             {"spread", stress.spread}});
    } else {
        const sim::cpu::PairStages pair = sim::cpu::pair_stages_for(model.kernel.choice);
        add({{"pack_motion", particle.pack_motion},
             {"find_tolerated", pair.find_tolerated},
             {"contacts", particle.contacts},
             {"update_multipliers", pair.update_multipliers},
             {"apply", pair.apply}});
    }
    add({{"resolve_penetration", particle.resolve_penetration},
         {"enforce_boundaries", particle.enforce_boundaries},
         update_velocities,
         {"apply_viscosity", particle.apply_viscosity},
         {"update_sleep", particle.update_sleep}});
}

Step::Step(const Debris& debris, params::InternalFriction method)
    : model_(with_method(debris.model(), method)),
      ground_(debris.ground()),
      state_(debris.state()),
      constants_(model_, state_),
      work_(state_.count),
      neighbours_(state_.count),
      stages_(model_) {
    run(stages_.predict);
    find_neighbours();
    remember();
}

/// As Backend::find_neighbours(), with the arrays that the stages read brought into the new order.
void Step::find_neighbours() {
    const auto radius = static_cast<float>(model_.support_radius);
    sim::cpu::CellSort cell_sort(state_.count);
    sim::cpu::CellGrid grid;
    sim::cpu::NeighbourSearch search(state_.count);
    const auto by_cell = cell_sort.sort(work_.predicted, state_.count, radius, grid);
    const auto [order, awake] = search.find(work_.predicted, by_cell, state_.asleep, grid, radius);
    const sim::State before = state_;
    state_.awake = awake;
    for (std::size_t i = 0; i < order.size(); ++i) state_.set_particle(i, before.particle(order[i]));
    search.write(neighbours_);
}

void Step::run_until(std::size_t place) {
    for (std::size_t i = 0; i < place; ++i) run(stages_.after_neighbours[i]);
}

void Step::run(const Stage& stage) {
    stage.run({constants_, model_, ground_, state_, work_, neighbours_}, 0,
              (state_.count + sim::block_size - 1) / sim::block_size);
}

void Step::remember() {
    memory_ = {work_.displaced, work_.motion,           state_.position,      state_.velocity,
               work_.shift,     work_.contact_friction, work_.corrected,      work_.end,
               state_.stress,   state_.multiplier,      work_.contact_normal, state_.still_time};
}

void Step::restore() {
    work_.displaced = memory_.displaced;
    work_.motion = memory_.motion;
    work_.corrected = memory_.corrected;
    work_.end = memory_.end;
    state_.position = memory_.position;
    state_.velocity = memory_.velocity;
    work_.shift = memory_.shift;
    work_.contact_friction = memory_.contact_friction;
    state_.stress = memory_.stress;
    state_.multiplier = memory_.multiplier;
    work_.contact_normal = memory_.contact_normal;
    state_.still_time = memory_.still_time;
    std::fill(state_.asleep.begin(), state_.asleep.end(), std::uint8_t{0});
}

}  // namespace talus::benchmarks
