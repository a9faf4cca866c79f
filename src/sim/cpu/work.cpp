#include "sim/cpu/work.hpp"

#include <algorithm>
#include <array>

namespace talus::sim::cpu {

Work::Work(std::size_t capacity) {
#define TALUS_RESIZE(array, name) resize(name, capacity);
    TALUS_WORK_ARRAYS(TALUS_RESIZE)
#undef TALUS_RESIZE
}

float sample_walls(const Model& model, const Ground& ground, const State& state, Work& work, std::size_t i,
                   const GroundFace<float>& base, const Vec3<float>& p, const Vec3<float>& displacement) {
    const Boundary<float> boundary = boundary_with(base, model, ground, p, grain_rank(state.id[i]));
    work.ground_slope[i] = boundary.faces[0].slope;
    work.boundary_gradient.set(i, boundary.gradient);
    work.has_walls[i] = boundary.faces[1].building >= 0;
    if (work.has_walls[i]) {
        work.wall_distance[i] = boundary.faces[1].distance;
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

Vec3<float> undo_overlap_near_walls(const Model& model, const Ground& ground, const State& state, Work& work,
                                    std::size_t i, const Vec3<float>& p, float max_shift,
                                    const Vec3<float>& above_ground) {
    Vec3<float> shift = Vec3<float>{} + above_ground;
    constexpr float beyond_rounding = 1e-3F;  // m
    const float least = work.wall_distance[i] - length(p - work.wall_place.at(i));
    work.wall_place.set(i, p);
    work.wall_distance[i] = least;
    if (least > static_cast<float>(model.contact_distance()) + beyond_rounding) return shift;
    const terrain::SolidSample<float> nearest =
        undo_wall_overlap(model, ground, p, max_shift, grain_rank(state.id[i]), shift);
    work.wall_distance[i] = nearest.building < 0 ? static_cast<float>(ground.solids.range()) : nearest.distance;
    return shift;
}

bool sweeps_clear_of_walls(const Model& model, const State& state, const Work& work, std::size_t i) {
    const std::array<float, 8>& displaced = work.displaced[i].v;
    const Vec3<float> start = state.position.at(i), displacement{displaced[4], displaced[5], displaced[6]};
    const Vec3<float> end = start + displacement;
    const auto longest = static_cast<float>(model.particle_spacing / 4);
    if (sweep_parts(length(work.shift.at(i)), longest) > 1) return false;
    const auto square_to = [&](const Vec3<float>& p) { return dot(p - end, p - end); };
    float farthest = square_to(end + work.shift.at(i));
    const int parts = sweep_parts(length(displacement), longest);
    for (int part = 1; part < parts; ++part) {
        const float share = static_cast<float>(part) / static_cast<float>(parts);
        farthest = std::max(farthest, square_to(start + displacement * share));
    }
    constexpr float beyond_rounding = 1 + 1e-4F;
    const float wall = work.wall_distance[i];
    return wall > 0 && farthest * beyond_rounding < wall * wall;
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
