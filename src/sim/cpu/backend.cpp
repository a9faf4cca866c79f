#include "sim/cpu/backend.hpp"

#include <algorithm>
#include <array>

#include "core/max_or_nan.hpp"
#include "sim/change.hpp"
#include "sim/compression.hpp"
#include "sim/particle_density.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/resistance.hpp"
#include "simd/parallel.hpp"

namespace talus::sim::cpu {
namespace {

Blocks everything(const State& state) {
    return {0, blocks_of(state.count)};
}
/// The last block may begin with sleeping debris: which no stage moves.
Blocks awake(const State& state) {
    return {0, blocks_of(state.awake)};
}
Blocks asleep(const State& state) {
    return {blocks_of(state.awake), blocks_of(state.count)};
}

}  // namespace

Backend::Backend(const Model& model, std::size_t capacity)
    : particle_stages_(particle_stages_for(model.kernel.choice)),
      stress_stages_(stress_stages_for(model.kernel.choice)),
      pair_stages_(pair_stages_for(model.kernel.choice)),
      columns_(capacity),
      cell_sort_(capacity),
      search_(capacity),
      neighbours_(capacity),
      work_(capacity),
      gone_(capacity),
      new_index_(capacity) {
    reordered_.resize(capacity);
    grid_.key.reserve(capacity + 1);
    grid_.start.reserve(capacity + 1);
}

void Backend::run(StageFunction stage, const Model& model, const Ground& ground, State& state, Blocks blocks) {
    const StageData data{constants_, model, ground, state, work_, neighbours_};
    simd::parallel_ranges(blocks.last - blocks.first, block_grain, [&](std::size_t first, std::size_t last) {
        stage(data, blocks.first + first, blocks.first + last);
    });
}

void Backend::run(StageFunction stage, const Model& model, const Ground& ground, State& state) {
    run(stage, model, ground, state, awake(state));
}

void Backend::begin_step(const Model& model, const State& state) {
    constants_ = StepConstants(model, state);
}

void Backend::release_held(const Model& model, State& state) {
    simd::parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i] && state.time >= start_time_of(model, state.id[i])) state.held[i] = 0;
        }
    });
}

void Backend::apply_drag(const Model& model, const Ground& ground, State& state) {
    const bool slows = slows_by_speed(model), evolves = model.evolving_pressure.on;
    if (!slows && !evolves) return;
    count_columns(model, ground, state);
    if (evolves) {
        make_room_for_soil(model, state);
        run(particle_stages_.evolve_soil, model, ground, state, everything(state));
    }
    if (slows) run(particle_stages_.drag, model, ground, state, everything(state));
}

void Backend::predict_positions(const Model& model, const Ground& ground, State& state) {
    run(particle_stages_.predict, model, ground, state, everything(state));
}

void Backend::count_columns(const Model& model, const Ground& ground, const State& state) {
    columns_.count(state.position, std::span(state.asleep).first(state.count), column_width(model));
    simd::parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.asleep[i] || state.held[i]) continue;
            const Vec3<float> p = state.position.at(i);
            work_.column_particles[i] =
                columns_.particles_at(p.x, p.y) / open_share(model, ground, p, grain_rank(state.id[i]));
        }
    });
}

void Backend::sort_particles(const Model& model, State& state) {
    by_cell_ = cell_sort_.sort(work_.predicted, state.count, model.support_radius, grid_);
}

void Backend::find_neighbours(const Model& model, State& state) {
    const auto found =
        search_.find(work_.predicted, by_cell_, state.asleep, grid_, static_cast<float>(model.support_radius));
    reorder(state, found.order);
    state.awake = found.awake;
    search_.write(neighbours_);
}

void Backend::prepare_particles(const Model& model, const Ground& ground, State& state) {
    run(particle_stages_.begin, model, ground, state, everything(state));
    // For awake particles, only pair friction needs the positions at the step's start; otherwise those at its end are
    // packed.
    run(particle_stages_.pack_motion, model, ground, state,
        constants_.keeps_stress ? asleep(state) : everything(state));
    if (constants_.resists_by_particle) run(particle_stages_.resist, model, ground, state);
}

void Backend::reorder(State& state, std::span<const std::uint32_t> order) {
    simd::parallel_ranges(order.size(), 1024, [&](std::size_t first, std::size_t last) {
        const auto gather = [&](const auto& from, auto& to) {
            for (std::size_t i = first; i < last; ++i) to[i] = from[order[i]];
        };
        for_each_array(state, reordered_, gather);
    });
    for_each_array(state, reordered_, [](auto& a, auto& b) { a.swap(b); });
}

void Backend::warm_start(const Model& model, const Ground& ground, State& state) {
    if (constants_.keeps_stress) {
        run(stress_stages_.linearise, model, ground, state);
        run(stress_stages_.press_asleep, model, ground, state, asleep(state));
        run(stress_stages_.apply, model, ground, state);
        run(stress_stages_.clear_asleep, model, ground, state, asleep(state));
    } else {
        run(pair_stages_.find_tolerated, model, ground, state);
    }
    state.previous_time_step = state.time_step;
}

void Backend::solve_density(const Model& model, const Ground& ground, State& state) {
    if (constants_.keeps_stress) {
        run(stress_stages_.solve, model, ground, state);
        run(stress_stages_.apply, model, ground, state);
    } else {
        run(pair_stages_.update_multipliers, model, ground, state);
        run(pair_stages_.apply, model, ground, state);
    }
}

void Backend::solve_contacts(const Model& model, const Ground& ground, State& state) {
    run(particle_stages_.contacts, model, ground, state);
}

void Backend::resolve_penetration(const Model& model, const Ground& ground, State& state) {
    if (constants_.keeps_stress) {
        run(stress_stages_.find_spread, model, ground, state);
        run(stress_stages_.spread, model, ground, state);
    }
    run(particle_stages_.resolve_penetration, model, ground, state);
}

void Backend::enforce_boundaries(const Model& model, const Ground& ground, State& state) {
    run(particle_stages_.enforce_boundaries, model, ground, state);
}

void Backend::measure_compression(const Model&, State& state) const {
    const CompressionSum compression = simd::reduce_ranges(
        state.awake, 4096, CompressionSum{},
        [&](std::size_t first, std::size_t last, CompressionSum sum) {
            for (std::size_t i = first; i < last; ++i) sum.add(work_.compression[i], work_.tolerated_compression[i]);
            return sum;
        },
        [](const CompressionSum& a, const CompressionSum& b) { return a + b; });
    compression.write(state, state.count);
}

void Backend::update_velocities(const Model& model, const Ground& ground, State& state) {
    const StageData data{constants_, model, ground, state, work_, neighbours_};
    state.max_speed = simd::reduce_ranges(
        awake(state).last, block_grain, 0.0f,
        [&](std::size_t first, std::size_t last, float max) {
            return max_or_nan(max, particle_stages_.update_velocities(data, first, last));
        },
        max_or_nan);
}

void Backend::measure_impacts(const Model& model, const Ground& ground, State& state) const {
    state.building_contacts.clear();
    if (ground.solids.empty()) return;
    for (std::uint32_t i = 0; i < state.awake; ++i) {
        if (!work_.has_walls[i]) continue;
        const double mass = density_of(model, state, i) * model.particle_volume();
        const WallContacts& walls = work_.walls[i];
        for (std::size_t f = 0; f < walls.faces.size(); ++f) {
            const BoundaryFace<float>& wall = walls.faces[f];
            if (wall.building < 0) break;
            const float normal = walls.contacts[f].normal + boundary_push(wall.slope, state.multiplier[i]);
            if (normal <= 0) continue;
            const std::array<float, 8>& displaced = work_.displaced[i].v;
            const Vec3<float> end{displaced[0], displaced[1], displaced[2]};
            const Vec3<float> displacement{displaced[4], displaced[5], displaced[6]};
            state.building_contacts.push_back({i, wall.building, static_cast<float>(mass * normal / state.time_step),
                                               end - wall.normal * (wall.distance + dot(displacement, wall.normal)),
                                               speed_without_push(displacement, wall.normal, normal, state.time_step)});
        }
    }
}

void Backend::apply_viscosity(const Model& model, const Ground& ground, State& state) {
    if (model.viscosity > 0) run(particle_stages_.apply_viscosity, model, ground, state);
}

void Backend::update_sleep(const Model& model, const Ground& ground, State& state) {
    if (model.solver.rest_duration > 0) run(particle_stages_.update_sleep, model, ground, state);
}

void Backend::remove_outflow(const Model&, const Ground& ground, State& state) {
    const bool any = simd::reduce_ranges(
        state.awake, 2048, false,
        [&](std::size_t first, std::size_t last, bool found) {
            for (std::size_t i = first; i < last; ++i) {
                gone_[i] = !ground.terrain.covers(state.position.x[i], state.position.y[i]);
                found = found || gone_[i];
            }
            return found;
        },
        [](bool a, bool b) { return a || b; });
    if (!any) return;
    std::fill(gone_.begin() + state.awake, gone_.begin() + state.count, std::uint8_t{0});
    std::vector<std::uint32_t>& moved_to = new_index_;
    state.outflow += state.remove_if([&](std::uint32_t i) { return gone_[i] != 0; },
                                     [&](std::uint32_t i, std::uint32_t k) { moved_to[i] = k; });
    std::erase_if(state.building_contacts, [&](const BuildingContact& c) { return gone_[c.particle] != 0; });
    for (BuildingContact& contact : state.building_contacts) contact.particle = moved_to[contact.particle];
}

}  // namespace talus::sim::cpu
