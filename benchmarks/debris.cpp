#include "debris.hpp"

#include <map>
#include <memory>
#include <span>

namespace talus::benchmarks {
namespace {

constexpr int steps = 20;  // until the lattice that debris starts as has come into disorder

Model with_method(Model model, InternalFriction method) {
    model.solver.internal_friction = method;
    return model;
}

}  // namespace

Debris::Debris(int particles) : start(*bench::make_start("slab", particles, "")), simulation(start.model, start.state) {
    for (int step = 0; step < steps; ++step) (void)simulation.advance();
}

const Debris& debris_of(std::int64_t particles) {
    static std::map<std::int64_t, std::unique_ptr<Debris>> made;
    auto& debris = made[particles];
    if (!debris) debris = std::make_unique<Debris>(static_cast<int>(particles));
    return *debris;
}

Stages::Stages(const Model& model) {
    const cpu::ParticleStages particle = cpu::particle_stages_for(model.kernel.choice);
    const Stage update_velocities = {"update_velocities", [update = particle.update_velocities](
                                                              const cpu::StageData& data, std::size_t first,
                                                              std::size_t last) { (void)update(data, first, last); }};
    predict = {"predict", particle.predict};
    after_neighbours = {{"begin", particle.begin}};
    const auto add = [this](std::initializer_list<Stage> more) {
        after_neighbours.insert(after_neighbours.end(), more);
    };
    if (model.solver.internal_friction == InternalFriction::stress) {
        const cpu::StressStages stress = cpu::stress_stages_for(model.kernel.choice);
        add({{"linearise", stress.linearise},
             {"contacts", particle.contacts},
             {"solve", stress.solve},
             {"apply", stress.apply},
             {"find_spread", stress.find_spread},
             {"spread", stress.spread}});
    } else {
        const cpu::PairStages pair = cpu::pair_stages_for(model.kernel.choice);
        add({{"pack_start", pair.pack_start},
             {"find_tolerated", pair.find_tolerated},
             {"contacts", particle.contacts},
             {"update_multipliers", pair.update_multipliers},
             {"apply", pair.apply}});
    }
    add({{"undo_overlaps", particle.undo_overlaps},
         {"enforce_boundaries", particle.enforce_boundaries},
         update_velocities,
         {"apply_viscosity", particle.apply_viscosity},
         {"settle", particle.settle}});
}

Step::Step(const Debris& debris, InternalFriction method)
    : model_(with_method(debris.model(), method)),
      state_(debris.state()),
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
    cpu::CellSort cell_sort(state_.count);
    cpu::CellGrid grid;
    cpu::NeighbourSearch search(state_.count);
    const auto by_cell = cell_sort.sort(work_.predicted, state_.count, radius, grid);
    const auto [order, awake] = search.find(work_.predicted, by_cell, state_.resting, grid, radius);
    const State before = state_;
    state_.awake = awake;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::uint32_t from = order[i];
        state_.position.set(i, before.position.at(from));
        state_.velocity.set(i, before.velocity.at(from));
        state_.stress.set(i, before.stress.at(from));
        state_.multiplier[i] = before.multiplier[from];
        state_.id[i] = before.id[from];
        state_.held[i] = before.held[from];
        state_.calm_time[i] = before.calm_time[from];
        state_.resting[i] = before.resting[from];
    }
    search.write(neighbours_);
}

void Step::run_until(std::size_t place) {
    for (std::size_t i = 0; i < place; ++i) run(stages_.after_neighbours[i]);
}

void Step::run(const Stage& stage) {
    stage.run({model_, state_, work_, neighbours_}, 0, (state_.count + bundle_size - 1) / bundle_size);
}

void Step::remember() {
    memory_ = {work_.motion,      work_.predicted,        state_.position, state_.velocity,
               work_.shift,       work_.contact_friction, work_.corrected, state_.stress,
               state_.multiplier, work_.contact_normal,   state_.calm_time};
}

void Step::restore() {
    work_.motion = memory_.motion;
    work_.corrected = memory_.corrected;
    work_.predicted = memory_.predicted;
    state_.position = memory_.position;
    state_.velocity = memory_.velocity;
    work_.shift = memory_.shift;
    work_.contact_friction = memory_.contact_friction;
    state_.stress = memory_.stress;
    state_.multiplier = memory_.multiplier;
    work_.contact_normal = memory_.contact_normal;
    state_.calm_time = memory_.calm_time;
    std::fill(state_.resting.begin(), state_.resting.end(), std::uint8_t{0});
}

}  // namespace talus::benchmarks
