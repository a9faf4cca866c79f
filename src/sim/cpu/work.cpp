#include "sim/cpu/work.hpp"

#include <cmath>

namespace talus::cpu {

Work::Work(std::size_t capacity) : has_walls(capacity + array_padding), walls(capacity + array_padding) {
    for (VectorArray* array : {&predicted, &corrected, &shift, &ground_normal, &boundary_gradient, &contact_friction}) {
        array->resize(capacity);
    }
    for (std::vector<Oct>* array : {&motion, &stress}) array->resize(capacity + array_padding);
    for (std::vector<float>* array :
         {&column_particles, &mobile, &ground_distance, &ground_slope, &constraint_start, &surface_share,
          &gradient_square, &pair_square, &compression, &tolerated_compression, &contact_normal, &ground_friction,
          &ground_strength, &effective_share, &ground_shear}) {
        array->resize(capacity + array_padding);
    }
}

float sample_walls(const Model& model, const State& state, Work& work, std::size_t i, const Vec3<float>& p,
                   const Vec3<float>& displacement) {
    const Boundary<float> boundary = sample_boundary(model, p, grain_rank(state.id[i]));
    const BoundaryFace<float>& ground = boundary.faces[0];
    work.ground_distance[i] = ground.distance - dot(displacement, ground.normal);
    work.ground_slope[i] = ground.slope;
    work.ground_normal.set(i, ground.normal);
    work.boundary_gradient.set(i, boundary.gradient);
    work.has_walls[i] = boundary.faces[1].building >= 0;
    if (work.has_walls[i]) {
        Work::Walls& walls = work.walls[i];
        for (std::size_t f = 0; f < walls.faces.size(); ++f) {
            walls.faces[f] = boundary.faces[f + 1];
            walls.faces[f].distance -= dot(displacement, walls.faces[f].normal);
        }
    }
    return boundary.density;
}

Vec3<float> resolve_wall_contacts(const Model& model, Work& work, std::size_t i, float multiplier,
                                  Vec3<float> displacement) {
    Work::Walls& walls = work.walls[i];
    const float effective = resists_by_particle(model) ? work.effective_share[i] : 1;
    const float friction = static_cast<float>(model.building_friction_coefficient) * effective;
    for (std::size_t f = 0; f < walls.faces.size(); ++f) {
        const BoundaryFace<float>& wall = walls.faces[f];
        if (wall.building < 0) break;
        displacement += resolve_face(model, wall.distance + dot(displacement, wall.normal), wall.normal, displacement,
                                     boundary_push(wall.slope, multiplier), friction, 0.0f, walls.contacts[f]);
    }
    return displacement;
}

Vec3<float> undo_overlap_near_walls(const Model& model, const State& state, std::size_t i, const Vec3<float>& p,
                                    float most) {
    return undo_overlap(model, p, most, grain_rank(state.id[i]));
}

void enforce_particle(const Model& model, const State& state, Work& work, std::size_t i) {
    std::array<float, 8>& motion = work.motion[i].v;
    const Vec3<float> start = state.position.at(i), displacement{motion[4], motion[5], motion[6]};
    const Vec3<float> wanted = start + displacement;
    const float rank = grain_rank(state.id[i]);
    const Vec3<float> end = free_end(model, start, displacement, rank);
    work.predicted.set(i, free_end(model, end, work.shift.at(i), rank));
    if (end.x == wanted.x && end.y == wanted.y && end.z == wanted.z) return;
    // What puts a particle back above ground must not speed it up.
    const Vec3<float> reached = end - start;
    const float before = dot(displacement, displacement), after = dot(reached, reached);
    const Vec3<float> slowed = after > before ? reached * std::sqrt(before / after) : reached;
    motion[4] = slowed.x;
    motion[5] = slowed.y;
    motion[6] = slowed.z;
}

}  // namespace talus::cpu
