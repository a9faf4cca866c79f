#include "sim/cpu/backend.hpp"

#include <algorithm>
#include <cmath>

#include "sim/cpu/parallel.hpp"
#include "sim/physics/contact.hpp"
#include "sim/physics/viscosity.hpp"

namespace talus::cpu {
namespace {

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
      boundary_(capacity),
      multiplier_change_(capacity),
      constraint_(capacity),
      compression_(capacity),
      tolerated_compression_(capacity),
      contacts_(capacity),
      gone_(capacity),
      float_scratch_(capacity),
      id_scratch_(capacity),
      byte_scratch_(capacity) {
    for (VectorArray* array : {&displacement_, &shift_, &predicted_, &sampled_at_, &vector_scratch_}) {
        array->resize(capacity);
    }
    packed_points_.resize(capacity);
    packed_vectors_.resize(capacity);
    packed_rows_.resize(capacity);
    packed_rest_.resize(capacity);
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
            contacts_[i] = {};
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

bool Backend::keeps_stress(const Model& model) {
    return model.solver.internal_friction == InternalFriction::stress;
}

void Backend::warm_start(const Model& model, State& state) {
    if (keeps_stress(model)) {
        warm_start_stress(model, state);
    } else {
        start_pairs(model, state);
    }
}

void Backend::solve_density(const Model& model, State& state) {
    if (keeps_stress(model)) {
        solve_stress(model, state);
    } else {
        solve_pairs(model, state);
    }
    measure_compression(state);
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

/// Contact with ground and buildings, and the basal part of eq. (4).
void Backend::solve_contacts(const Model& model, State& state) {
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) continue;
            const Vec3<float> displacement = resolve_contacts(model, boundary_[i], sampled_at_.at(i),
                                                              displacement_.at(i), state.multiplier[i], contacts_[i]);
            displacement_.set(i, displacement);
            predicted_.set(i, state.position.at(i) + displacement);
        }
    });
}

/// What overlaps is moved apart, and its velocity left alone: debris that is too dense, debris that touches ground or
/// walls too closely.
void Backend::undo_overlaps(const Model& model, State& state) {
    const bool spreads = keeps_stress(model);
    if (spreads) spread(model, state);
    const auto most = static_cast<float>(model.particle_spacing / 4);
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Vec3<float> shift = spreads && !state.held[i] ? shift_.at(i) : Vec3<float>{};
            if (!state.held[i]) shift += undo_overlap(model, predicted_.at(i), most);
            const float size = length(shift);
            shift_.set(i, size > most ? shift * (most / size) : shift);
        }
    });
}

void Backend::enforce_boundaries(const Model& model, State& state) {
    parallel_ranges(state.count, particle_grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i]) continue;
            const Vec3<float> start = state.position.at(i), displacement = displacement_.at(i);
            const Vec3<float> wanted = start + displacement;
            const Vec3<float> end = free_end(model, start, displacement);
            predicted_.set(i, free_end(model, end, shift_.at(i)));
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
    state.largest_speed = reduce_ranges(
        state.count, 4096, 0.0f,
        [&](std::size_t first, std::size_t last, float largest) {
            for (std::size_t i = first; i < last; ++i) {
                if (state.held[i]) continue;
                const Vec3<float> velocity = displacement_.at(i) * inverse_dt;
                state.velocity.set(i, velocity);
                state.position.set(i, predicted_.at(i));
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
        for (std::size_t f = 1; f < face_count; ++f) {
            const BoundaryFace<float>& wall = boundary_[i].faces[f];
            if (wall.building < 0) break;
            const float normal = contacts_[i][f].normal + boundary_push(wall, state.multiplier[i]);
            if (normal <= 0) continue;
            state.building_contacts.push_back({i, wall.building, static_cast<float>(mass * normal / state.time_step)});
        }
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
    const double reach = model.solver.displacement_limit * model.particle_spacing;
    double dt = model.solver.largest_time_step;
    // Pressure spreads by some layers per step. Debris that packs closer is deeper than it can keep up with; left
    // alone, particles end up on top of each other, where no gradient parts them.
    constexpr double too_compressed = 0.01, recovered = 0.005;
    if (state.time_step > 0 && state.mean_compression > recovered) {
        const double eased = state.mean_compression > too_compressed ? state.time_step / 2 : state.time_step;
        dt = std::clamp(eased, std::max(dt / 8, std::min(dt, model.solver.smallest_time_step)), dt);
    }
    while (dt > model.solver.smallest_time_step && dt * (state.largest_speed + model.gravity * dt) > reach) dt /= 2;
    return dt;
}

}  // namespace talus::cpu
