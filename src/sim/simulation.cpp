#include "sim/simulation.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/hash.hpp"
#include "sim/cpu/parallel.hpp"
#include "sim/fault.hpp"
#include "sim/step.hpp"

namespace talus {

Simulation::Simulation(Model model, State state, std::uint32_t expected)
    : model_(std::move(model)),
      state_(std::move(state)),
      expected_(expected),
      capacity_(state_.count + expected),
      highest_energy_head_(std::numeric_limits<double>::lowest()) {
    if (expected > 0) state_.resize(capacity_);
    backend_.emplace(model_, capacity_);
    take_energy_and_speed();
}

void Simulation::take_energy_and_speed() {
    for (std::uint32_t i = 0; i < state_.count; ++i) {
        const LocalPoint v = state_.velocity.at(i);
        highest_energy_head_ = std::max(highest_energy_head_, state_.position.z[i] + dot(v, v) / (2 * model_.gravity));
        state_.largest_speed = std::max<double>(state_.largest_speed, length(v));
    }
    state_.building_contacts.reserve((face_count - 1) * std::max(state_.count, capacity_));
}

std::optional<std::string> Simulation::advance() {
    state_.time_step = cpu::choose_time_step(model_, state_);
    step(*backend_, model_, state_, times_);
    return find_fault(model_, state_, highest_energy_head_);
}

void Simulation::change(const std::function<void(Model&, State&)>& edit) {
    edit(model_, state_);
    state_.building_contacts.clear();
    if (state_.count > capacity_) {
        // The backend changes its arrays with those of the state: both must have the same room.
        capacity_ = state_.count + expected_;
        state_.resize(capacity_);
        backend_.emplace(model_, capacity_);
    }
    take_energy_and_speed();
}

std::uint64_t hash_state(const State& state) {
    std::vector<std::uint32_t> order(state.count);
    for (std::uint32_t i = 0; i < state.count; ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return state.id[a] < state.id[b]; });
    StateHash hash;
    hash.add(&state.time, sizeof state.time);
    for (const std::uint32_t i : order) {
        const std::array<float, 6> values = {state.position.x[i], state.position.y[i], state.position.z[i],
                                             state.velocity.x[i], state.velocity.y[i], state.velocity.z[i]};
        hash.add(&state.id[i], sizeof state.id[i]);
        hash.add(values.data(), sizeof values);
    }
    return hash.value();
}

double kinetic_energy(const Model& model, const State& state) {
    return model.particle_mass() / 2 *
           cpu::reduce_ranges(
               state.count, 4096, 0.0,
               [&](std::size_t first, std::size_t last, double sum) {
                   for (std::size_t i = first; i < last; ++i) {
                       const double x = state.velocity.x[i], y = state.velocity.y[i], z = state.velocity.z[i];
                       sum += x * x + y * y + z * z;
                   }
                   return sum;
               },
               [](double a, double b) { return a + b; });
}

double potential_energy(const Model& model, const State& state) {
    return model.particle_mass() * model.gravity *
           cpu::reduce_ranges(
               state.count, 4096, 0.0,
               [&](std::size_t first, std::size_t last, double sum) {
                   for (std::size_t i = first; i < last; ++i) sum += state.position.z[i];
                   return sum;
               },
               [](double a, double b) { return a + b; });
}

}  // namespace talus
