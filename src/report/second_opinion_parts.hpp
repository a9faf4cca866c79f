#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "report/second_opinion.hpp"

/// What the sentences, the tables and the maps of the comparison share.
namespace talus::report {

/// In which models a structure is hit.
enum HitBy { neither, depth_averaged_only, particles_only, both };
inline constexpr std::array<const char*, 4> hit_by_names = {"neither", "depth-averaged only", "particles only", "both"};

inline HitBy hit_by(const observe::BuildingImpact& particles, const observe::BuildingImpact& depth_averaged) {
    return static_cast<HitBy>((depth_averaged.hit ? 1 : 0) + (particles.hit ? 2 : 0));
}

/// The structures of both runs, side by side.
template <class F>
void for_each_structure(const BothModels& models, const F& f) {
    const auto &p = models.particles.observation.buildings, &d = models.depth_averaged.observation.buildings;
    for (std::size_t i = 0; i < std::min(p.size(), d.size()); ++i) f(p[i], d[i], hit_by(p[i], d[i]));
}

inline std::string name_of(const observe::BuildingImpact& impact) {
    return impact.name.empty() ? "unnamed" : impact.name;
}

/// Of the depth-averaged model against the particles; NaN: one of them has no value.
inline double percent_more(double particles, double depth_averaged) {
    return particles > 0 ? 100 * (depth_averaged / particles - 1) : observe::never;
}

}  // namespace talus::report
