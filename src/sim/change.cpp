#include "sim/change.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sim/physics/net.hpp"
#include "sim/relax.hpp"

namespace talus::sim {

void append_particles(State& state, const State& more, std::uint32_t first_id) {
    // Multipliers and stresses are pressures times the square of their time step.
    if (state.count == 0 || !(state.previous_time_step > 0)) state.previous_time_step = more.previous_time_step;
    const double ratio = more.previous_time_step > 0 ? state.previous_time_step / more.previous_time_step : 0;
    const auto scale = static_cast<float>(ratio * ratio);
    const std::uint32_t count = state.count + more.count;
    // Never shrinks the arrays: the backend relies on that.
    state.resize(std::max<std::size_t>(count, state.room()));
    for (std::uint32_t k = 0; k < more.count; ++k) {
        Particle p = more.particle(k);
        p.multiplier *= scale;
        p.stress = p.stress * scale;
        p.id += first_id;
        p.still_time = 0;
        p.asleep = 0;
        state.set_particle(state.count + k, p);
    }
    if (!more.soil_of_id.empty()) {
        state.soil_of_id.resize(first_id);
        state.soil_of_id.insert(state.soil_of_id.end(), more.soil_of_id.begin(), more.soil_of_id.end());
    }
    state.count = count;
    state.seeded += more.seeded;
    state.outflow += more.outflow;
}

std::uint32_t add_particle(State& state, const LocalPoint& position, const LocalPoint& velocity, float multiplier) {
    Particle added;
    added.position = position;
    added.velocity = velocity;
    added.multiplier = multiplier;
    added.id = state.seeded++;
    state.set_particle(state.count, added);
    return state.count++;
}

void set_density(State& state, std::uint32_t particle, double density) {
    const std::uint32_t id = state.id[particle];
    if (state.density_of_id.size() <= id) {
        state.density_of_id.reserve(state.id.size());
        state.density_of_id.resize(std::size_t{id} + 1, 0);
    }
    state.density_of_id[id] = static_cast<float>(density);
}

void set_entry(const Model& model, State& state, std::uint32_t particle, double time, double pore_pressure_ratio,
               std::optional<double> solid_fraction) {
    if (!(model.pore_pressure_decay_time > 0) && pore_pressure_ratio < 0 && !solid_fraction) return;
    const std::uint32_t id = state.id[particle];
    if (state.entry_of_id.size() <= id) {
        state.entry_of_id.reserve(state.id.size());
        state.entry_of_id.resize(std::size_t{id} + 1);
    }
    state.entry_of_id[id] = {static_cast<float>(time), static_cast<float>(pore_pressure_ratio),
                             static_cast<float>(solid_fraction.value_or(-1))};
}

void make_room_for_soil(const Model& model, State& state) {
    if (!model.evolving_pressure.on || state.soil_of_id.size() >= state.seeded) return;
    state.soil_of_id.reserve(state.room());
    state.soil_of_id.resize(state.seeded);
}

void forget_soil(const Model& model, State& state) {
    if (model.evolving_pressure.on) std::fill(state.soil_of_id.begin(), state.soil_of_id.end(), Soil<float>{});
}

void remove_particles(State& state, std::uint32_t first, std::uint32_t last) {
    state.removed += state.remove_if([&](std::uint32_t i) { return state.id[i] >= first && state.id[i] < last; },
                                     [](std::uint32_t, std::uint32_t) {});
}

void wake(State& state, const Extent& local) {
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (!local.contains({state.position.x[i], state.position.y[i]})) continue;
        state.asleep[i] = 0;
        state.still_time[i] = 0;
    }
}

void clear_solids(const Model& model, const Ground& ground, State& state, const Extent& local) {
    std::vector<std::uint32_t> moved;
    Extent around;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        LocalPoint p = state.position.at(i), v = state.velocity.at(i);
        const float rank = grain_rank(state.id[i]);
        if (state.held[i] != 0 || !local.contains({p.x, p.y}) || !ground.solids.inside(p, rank)) continue;
        push_out_of_solids(model, ground, p, rank, [&](const LocalPoint& normal) {
            const float into = dot(v, normal);
            if (into < 0) v -= normal * into;
        });
        const PlanPoint before{state.position.x[i], state.position.y[i]};
        if (moved.empty()) around = {before.x, before.y, before.x, before.y};
        around.include(before);
        around.include({p.x, p.y});
        moved.push_back(i);
        state.position.set(i, p);
        state.velocity.set(i, v);
        state.multiplier[i] = 0;
        state.stress.set(i, {});
    }
    if (moved.empty()) return;

    // Surrounding debris makes room; debris beyond it stays fixed.
    const Extent yields = around.grown(3 * model.support_radius), stands = yields.grown(model.support_radius);
    State part;
    std::vector<std::uint32_t> source;
    std::unordered_map<std::uint32_t, std::uint32_t> source_of_id;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (stands.contains({state.position.x[i], state.position.y[i]})) source.push_back(i);
    }
    part.resize(source.size());
    part.count = part.seeded = static_cast<std::uint32_t>(source.size());
    for (std::uint32_t k = 0; k < part.count; ++k) {
        const std::uint32_t i = source[k];
        part.position.set(k, state.position.at(i));
        part.id[k] = state.id[i];  // decides which nets it passes
        source_of_id[state.id[i]] = i;
        part.held[k] = state.held[i] != 0 || !yields.contains({state.position.x[i], state.position.y[i]});
    }
    push_apart(model, ground, part);
    for (std::uint32_t k = 0; k < part.count; ++k) {
        if (part.held[k] != 0) continue;
        const std::uint32_t i = source_of_id.at(part.id[k]);
        state.position.set(i, part.position.at(k));
        state.asleep[i] = 0;
    }
}

void remove_building(const Model& model, Ground& ground, State& state, std::size_t building) {
    const WorldPoint& origin = ground.terrain.frame().origin;
    const Extent e = extent_of(ground.buildings[building]);
    ground.remove_solid(building, model.support_radius);
    const Extent local{e.x_min - origin.x, e.y_min - origin.y, e.x_max - origin.x, e.y_max - origin.y};
    wake(state, local.grown(2 * model.support_radius));
}

}  // namespace talus::sim
