#include "sim/cpu/backend.hpp"

#include <algorithm>
#include <cmath>

#include "sim/cpu/parallel.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/viscosity.hpp"

namespace talus::cpu {
namespace {

constexpr std::size_t particle_grain = 256;

/// Start time of the release that a particle belongs to.
double start_time_of(const Model& model, std::uint32_t id) {
    for (const ReleaseGroup& release : model.releases) {
        if (id >= release.first_particle && id < release.last_particle) return release.start_time;
    }
    return 0;
}

}  // namespace

Backend::Backend(const Model& model, std::size_t capacity)
    : sums_(pair_sums_for(model.kernel.choice)),
      scale_(model.kernel),
      cell_sort_(capacity),
      neighbours_(capacity, sums_),
      multiplier_change_(capacity),
      compression_(capacity),
      tolerated_compression_(capacity),
      ground_contact_(capacity),
      building_contact_(capacity),
      building_(capacity),
      gone_(capacity),
      float_scratch_(capacity),
      id_scratch_(capacity),
      byte_scratch_(capacity) {
    for (VectorArray* array : {&displacement_, &displacement_next_, &predicted_, &ground_gradient_, &building_gradient_,
                               &ground_friction_, &building_friction_, &vector_scratch_}) {
        array->resize(capacity);
    }
    packed_points_.resize(capacity);
    packed_vectors_.resize(capacity);
    stress_start_.resize(capacity);
    stress_change_.resize(capacity);
    grid_.key.reserve(capacity);
    grid_.start.reserve(capacity + 1);
}

void Backend::predict_positions(const Model& model, State& state) {
    const auto dt = static_cast<float>(state.time_step);
    const auto fall = static_cast<float>(model.gravity * state.time_step);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i] && state.time >= start_time_of(model, state.id[i])) state.held[i] = 0;
            Vec3<float> displacement{};
            if (!state.held[i]) {
                state.velocity.z[i] -= fall;
                displacement = state.velocity.at(i) * dt;
            }
            displacement_.set(i, displacement);
            predicted_.set(i, state.position.at(i) + displacement);
            ground_contact_[i] = building_contact_[i] = 0;
            ground_friction_.set(i, {});
            building_friction_.set(i, {});
            building_[i] = -1;
        }
    });
}

void Backend::find_neighbours(const Model& model, State& state) {
    reorder(state, cell_sort_.sort(predicted_, state.count, model.support_radius, grid_));
    neighbours_.build(predicted_, grid_, static_cast<float>(model.support_radius));
}

void Backend::reorder(State& state, std::span<const std::uint32_t> order) {
    const auto gather = [&](auto& values, auto& scratch) {
        parallel_ranges(order.size(), 4096, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) scratch[i] = values[order[i]];
        });
        values.swap(scratch);
    };
    const auto gather_vectors = [&](VectorArray& array) {
        gather(array.x, vector_scratch_.x);
        gather(array.y, vector_scratch_.y);
        gather(array.z, vector_scratch_.z);
    };
    gather_vectors(state.position);
    gather_vectors(state.velocity);
    gather_vectors(displacement_);
    gather_vectors(predicted_);
    gather(state.multiplier, float_scratch_);
    gather(state.pressure, float_scratch_);
    for (auto* component : {&state.stress.xx, &state.stress.yy, &state.stress.xy, &state.stress.xz, &state.stress.yz}) {
        gather(*component, float_scratch_);
    }
    gather(state.id, id_scratch_);
    gather(state.held, byte_scratch_);
}

void Backend::pack(const VectorArray& from, std::size_t count, Packed& to) const {
    parallel_ranges(count, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) to[i] = {from.x[i], from.y[i], from.z[i], multiplier_change_[i]};
    });
}

/// Reads off the positions that the step starts from: the pair gradients along which what persists acts, and the
/// compression that is already there. That may be undone only slowly, since a correction turns into velocity: the
/// density constraint tolerates the rest.
void Backend::measure_start(const Model& model, const State& state) {
    const auto undone = static_cast<float>(model.solver.depenetration_speed * state.time_step / model.particle_spacing);
    pack(state.position, state.count, packed_points_);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const float density = sums_.density(scale_, neighbours_.pairs_of(i), packed_points_, i).density;
            const auto boundary = boundary_density(model, sample_boundary(model, state.position.at(i)));
            ground_gradient_.set(i, boundary.ground_gradient);
            building_gradient_.set(i, boundary.building_gradient);
            tolerated_compression_[i] = std::max(0.0f, density + boundary.density - 1 - undone);
        }
    });
}

/// What persists is a starting guess. Multipliers and stresses are pressures times dt^2, so they scale with the step.
void Backend::warm_start(const Model& model, State& state) {
    const bool keeps_stress = model.solver.internal_friction == InternalFriction::stress;
    const double ratio = state.previous_time_step > 0 ? state.time_step / state.previous_time_step : 0;
    const auto scale = static_cast<float>(keeps_stress ? ratio * ratio : 0);
    state.previous_time_step = state.time_step;
    measure_start(model, state);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            // Debris that is held keeps what it carries, ready for its start, and presses on nothing.
            const float kept = state.held[i] ? 1.0f : static_cast<float>(StressConstants::warm_start);
            state.multiplier[i] *= scale * kept;
            state.pressure[i] *= scale;
            const Deviator<float> stress = state.stress.at(i) * scale;
            state.stress.set(i, stress);
            stress_start_.set(i, stress);
            stress_change_.set(i, state.held[i] ? Deviator<float>{} : stress);
            multiplier_change_[i] = state.held[i] ? 0.0f : state.multiplier[i];
        }
    });
    if (!keeps_stress) return;
    apply_stress_changes(state);
    std::swap(displacement_, displacement_next_);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            predicted_.set(i, state.position.at(i) + displacement_.at(i));
        }
    });
}

void Backend::solve_density(const Model& model, State& state) {
    if (model.solver.internal_friction == InternalFriction::stress) {
        update_multipliers<InternalFriction::stress>(model, state);
        apply_stress_changes(state);
    } else {
        update_multipliers<InternalFriction::pair>(model, state);
        apply_pair_corrections(model, state);
    }
    measure_compression(state);
}

/// Eqs. (1) and (2): the density constraint G and its multiplier lambda, unilateral: debris resists compression only.
/// With stresses also the shear of this step and the stress that answers it: elastic from the step's start, then
/// limited by friction.
template <InternalFriction friction>
void Backend::update_multipliers(const Model& model, State& state) {
    constexpr bool keeps_stress = friction == InternalFriction::stress;
    const float softness = static_cast<float>(model.solver.constraint_relaxation * model.kernel.rest_gradient_sum);
    const auto under_relaxation = static_cast<float>(model.solver.under_relaxation);
    const auto internal_friction = static_cast<float>(model.internal_friction_coefficient);
    pack(predicted_, state.count, packed_points_);
    pack(displacement_, state.count, packed_vectors_);

    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) {
                multiplier_change_[i] = 0;
                stress_change_.set(i, {});
                compression_[i] = 0;
                continue;
            }
            const DensitySums sums =
                sums_.density_and_deformation(scale_, neighbours_.pairs_of(i), packed_points_, packed_vectors_, i);
            const auto boundary = boundary_density(model, sample_boundary(model, predicted_.at(i)));
            ground_gradient_.set(i, boundary.ground_gradient);
            building_gradient_.set(i, boundary.building_gradient);
            const Vec3<float> gradient = sums.gradient + boundary.ground_gradient + boundary.building_gradient;
            const float pair_square = sums.square + softness;
            const float constraint = sums.density + boundary.density - 1;
            const float gradient_square = pair_square + dot(gradient, gradient);
            const float before = state.multiplier[i];
            const float after =
                gradient_square > 0
                    ? std::min(0.0f,
                               before - under_relaxation * (constraint - tolerated_compression_[i]) / gradient_square)
                    : before;
            state.multiplier[i] = after;
            multiplier_change_[i] = after - before;
            compression_[i] = std::max(0.0f, constraint);

            if constexpr (keeps_stress) {
                Deviator<float> stress = stress_start_.at(i);
                if (pair_square > 0) {
                    const float stiffness = static_cast<float>(StressConstants::stiffness) / pair_square;
                    stress = stress + sums.deformation.shear() * stiffness;
                }
                stress = limit_to_friction(stress, internal_friction, state.pressure[i]);
                stress_change_.set(i, stress - state.stress.at(i));
                state.stress.set(i, stress);
            }
        }
    });
}

void Backend::measure_compression(State& state) {
    struct Sum {
        double sum = 0;
        float greatest = 0;
    };
    const Sum compression = reduce_ranges(
        state.count, 4096, Sum{},
        [&](std::size_t first, std::size_t last, Sum s) {
            for (std::size_t i = first; i < last; ++i) {
                s.sum += compression_[i];
                s.greatest = std::max(s.greatest, compression_[i]);
            }
            return s;
        },
        [](const Sum& a, const Sum& b) {
            return Sum{a.sum + b.sum, std::max(a.greatest, b.greatest)};
        });
    state.mean_compression = state.count > 0 ? compression.sum / state.count : 0;
    state.max_compression = compression.greatest;
}

/// Eq. (3) with the full stress: x_i += sum_j [(d lambda_i + d lambda_j) I + ds_i + ds_j] V grad W, equal and opposite
/// for the two particles of a pair.
void Backend::apply_stress_changes(const State& state) {
    parallel_ranges(state.count, 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const float pressure = multiplier_change_[i];
            const Deviator<float> s = stress_change_.at(i);
            packed_points_[i] = {pressure + s.xx, s.xy, s.xz, pressure + s.yy};
            packed_vectors_[i] = {s.yz, pressure - s.xx - s.yy, 0, 0};
        }
    });
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Vec3<float> moved = displacement_.at(i);
            if (!state.held[i]) {
                moved += (ground_gradient_.at(i) + building_gradient_.at(i)) * multiplier_change_[i] +
                         sums_.stress_correction(neighbours_.pairs_of(i), packed_points_, packed_vectors_, i);
            }
            displacement_next_.set(i, moved);
        }
    });
}

/// Eqs. (3) and (4) as published: pairs pressed together rub against each other. Equal and opposite as well.
void Backend::apply_pair_corrections(const Model& model, const State& state) {
    const auto cap = static_cast<float>(pair_friction_cap(model.internal_friction_coefficient));
    pack(predicted_, state.count, packed_points_);  // again: multipliers have changed
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Vec3<float> moved = displacement_.at(i);
            if (!state.held[i]) {
                moved +=
                    (ground_gradient_.at(i) + building_gradient_.at(i)) * multiplier_change_[i] +
                    sums_.pair_correction(scale_, neighbours_.pairs_of(i), packed_points_, packed_vectors_, cap, i);
            }
            displacement_next_.set(i, moved);
        }
    });
}

/// Contact with ground and buildings, and the basal part of eq. (4).
void Backend::solve_contacts(const Model& model, State& state) {
    const auto depenetration = static_cast<float>(model.solver.depenetration_speed * state.time_step);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) continue;
            ContactMemory<float> ground{ground_contact_[i], ground_friction_.at(i)};
            ContactMemory<float> wall{building_contact_[i], building_friction_.at(i)};
            const float ground_push = -state.multiplier[i] * length(ground_gradient_.at(i));
            const float building_push = -state.multiplier[i] * length(building_gradient_.at(i));
            const Vec3<float> start = state.position.at(i);
            const Vec3<float> displacement = resolve_contacts(model, start, displacement_next_.at(i), depenetration,
                                                              ground_push, building_push, ground, wall, building_[i]);
            ground_contact_[i] = ground.normal;
            ground_friction_.set(i, ground.friction);
            building_contact_[i] = wall.normal;
            building_friction_.set(i, wall.friction);
            displacement_next_.set(i, displacement);
            predicted_.set(i, start + displacement);
        }
    });
    std::swap(displacement_, displacement_next_);
}

void Backend::enforce_boundaries(const Model& model, State& state) {
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) continue;
            const Vec3<float> start = state.position.at(i), displacement = displacement_.at(i);
            const Vec3<float> wanted = start + displacement;
            const Vec3<float> end = free_end(model, start, displacement);
            predicted_.set(i, end);
            if (end.x == wanted.x && end.y == wanted.y && end.z == wanted.z) continue;
            // What puts a particle back above ground must not speed it up.
            const Vec3<float> moved = end - start;
            const float before = dot(displacement, displacement), after = dot(moved, moved);
            displacement_.set(i, after > before ? moved * std::sqrt(before / after) : moved);
        }
    });
}

void Backend::update_velocities(const Model& model, State& state) {
    const auto inverse_dt = static_cast<float>(1 / state.time_step);
    constexpr auto smoothing = static_cast<float>(StressConstants::pressure_smoothing);
    state.largest_speed = reduce_ranges(
        state.count, 4096, 0.0f,
        [&](std::size_t first, std::size_t last, float largest) {
            for (std::size_t i = first; i < last; ++i) {
                if (state.held[i]) continue;
                const Vec3<float> velocity = displacement_.at(i) * inverse_dt;
                state.velocity.set(i, velocity);
                state.position.set(i, predicted_.at(i));
                state.pressure[i] += smoothing * (-state.multiplier[i] - state.pressure[i]);
                const float speed = length(velocity);
                // A NaN must win, or it would go unseen.
                largest = std::isnan(largest) || speed <= largest ? largest : speed;
            }
            return largest;
        },
        [](float a, float b) { return std::isnan(a) || b <= a ? a : b; });

    state.building_contacts.clear();
    if (model.solids.empty()) return;
    const double mass = model.particle_mass();
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (building_[i] < 0) continue;
        const float normal = building_contact_[i] - state.multiplier[i] * length(building_gradient_.at(i));
        if (normal <= 0) continue;
        state.building_contacts.push_back({i, building_[i], static_cast<float>(mass * normal / state.time_step)});
    }
}

/// Eq. (5) as XSPH smoothing; the sum weighs both particles of a pair alike, so momentum is conserved.
void Backend::apply_viscosity(const Model& model, State& state) {
    if (model.viscosity <= 0) return;
    const auto smoothing = static_cast<float>(step_smoothing(model.viscosity, state.time_step));
    pack(state.position, state.count, packed_points_);
    pack(state.velocity, state.count, packed_vectors_);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Vec3<float> velocity = state.velocity.at(i);
            if (!state.held[i]) {
                velocity +=
                    sums_.velocity_difference(scale_, neighbours_.pairs_of(i), packed_points_, packed_vectors_, i) *
                    smoothing;
            }
            vector_scratch_.set(i, velocity);
        }
    });
    std::swap(state.velocity, vector_scratch_);
}

void Backend::remove_left(const Model& model, State& state) {
    const bool any = reduce_ranges(
        state.count, 4096, false,
        [&](std::size_t first, std::size_t last, bool found) {
            for (std::size_t i = first; i < last; ++i) {
                gone_[i] = !model.terrain.covers(state.position.x[i], state.position.y[i]);
                found = found || gone_[i];
            }
            return found;
        },
        [](bool a, bool b) { return a || b; });
    if (!any) return;
    std::vector<std::uint32_t>& moved_to = id_scratch_;
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        moved_to[i] = kept;
        if (gone_[i]) continue;
        state.position.set(kept, state.position.at(i));
        state.velocity.set(kept, state.velocity.at(i));
        state.multiplier[kept] = state.multiplier[i];
        state.pressure[kept] = state.pressure[i];
        state.stress.set(kept, state.stress.at(i));
        state.id[kept] = state.id[i];
        state.held[kept] = state.held[i];
        ++kept;
    }
    std::erase_if(state.building_contacts, [&](const BuildingContact& c) { return gone_[c.particle] != 0; });
    for (BuildingContact& contact : state.building_contacts) contact.particle = moved_to[contact.particle];
    state.left += state.count - kept;
    state.count = kept;
}

double choose_time_step(const Model& model, const State& state) {
    if (model.solver.time_step) return *model.solver.time_step;
    const double reach = model.particle_spacing / 2;
    double dt = model.solver.largest_time_step;
    while (dt > model.solver.smallest_time_step && dt * (state.largest_speed + model.gravity * dt) > reach) dt /= 2;
    return dt;
}

}  // namespace talus::cpu
