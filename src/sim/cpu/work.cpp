#include "sim/cpu/work.hpp"

#include <array>

namespace talus::sim::cpu {

Work::Work(std::size_t capacity) {
#define TALUS_RESIZE(array, name) resize(name, capacity);
    TALUS_WORK_ARRAYS(TALUS_RESIZE)
#undef TALUS_RESIZE
}

float sample_walls(const Model& model, const Ground& ground, const State& state, Work& work, std::size_t i,
                   const Vec3<float>& p, const Vec3<float>& displacement) {
    const Boundary<float> boundary = sample_boundary(model, ground, p, grain_rank(state.id[i]));
    const BoundaryFace<float>& base = boundary.faces[0];
    work.ground_distance[i] = base.distance - dot(displacement, base.normal);
    work.ground_slope[i] = base.slope;
    work.ground_normal.set(i, base.normal);
    work.boundary_gradient.set(i, boundary.gradient);
    work.has_walls[i] = boundary.faces[1].building >= 0;
    if (work.has_walls[i]) {
        WallContacts& walls = work.walls[i];
        for (std::size_t f = 0; f < walls.faces.size(); ++f) {
            walls.faces[f] = boundary.faces[f + 1];
            walls.faces[f].distance -= dot(displacement, walls.faces[f].normal);
        }
    }
    return boundary.density;
}

Vec3<float> resolve_wall_contacts(const Model& model, const StepConstants& step, Work& work, std::size_t i,
                                  float multiplier, const Vec3<float>& displacement) {
    const float share_of_grains = step.resists_by_particle ? work.effective_share[i] : 1;
    return resolve_walls(model, work.walls[i], multiplier, share_of_grains, displacement);
}

Vec3<float> undo_overlap_near_walls(const Model& model, const Ground& ground, const State& state, std::size_t i,
                                    const Vec3<float>& p, float max_shift) {
    return undo_overlap(model, ground, p, max_shift, grain_rank(state.id[i]));
}

void enforce_particle(const Model& model, const Ground& ground, const State& state, Work& work, std::size_t i) {
    std::array<float, 8>& displaced = work.displaced[i].v;
    const auto [end, kept] =
        end_of_step(model, ground, state.position.at(i), Vec3<float>{displaced[4], displaced[5], displaced[6]},
                    work.shift.at(i), grain_rank(state.id[i]));
    work.end.set(i, end);
    displaced[4] = kept.x;
    displaced[5] = kept.y;
    displaced[6] = kept.z;
}

}  // namespace talus::sim::cpu
