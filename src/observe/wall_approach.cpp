#include "observe/wall_approach.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus::observe {

void WallApproach::update(const sim::Model& model, const Debris& debris, const WallPatches& patches) {
    flows_.clear();
    const std::vector<WallPatches::Column>& columns = patches.columns();
    if (columns.empty()) return;
    sums_.resize(columns.size());
    debris.find_beside_walls(model, patches, beside_);
    const double size = model.particle_spacing, volume = model.particle_volume(), area = size * size;
    for (const WallParticle& particle : beside_.found) {
        const LocalPoint p = particle.position, v = particle.velocity;
        for (const std::uint32_t k : patches.near(p.x, p.y)) {
            const WallPatches::Column& column = columns[k];
            if (column.roof) continue;
            const WallPatches::Column::Place place = column.place_of(p);
            if (place.out <= 0 || place.out - size / 2 >= edge_) continue;
            const double along = WallPatches::overlap(place.along, size, column.width);
            if (!(along > 0)) continue;
            const double part = along * WallPatches::overlap(place.out, size, edge_) / area * volume;
            if (!(part > 0)) continue;
            Sum& sum = sums_[k];
            if (sum.volume == 0) wetted_.push_back(k);
            sum.volume += part;
            sum.mass += part * particle.density;
            sum.x += part * v.x;
            sum.y += part * v.y;
            sum.z += part * v.z;
        }
    }
    for (const std::uint32_t k : wetted_) {
        const WallPatches::Column& column = columns[k];
        const Sum sum = std::exchange(sums_[k], {});
        const double out = (sum.x * column.along_y - sum.y * column.along_x) / sum.volume;
        flows_.push_back({column.building, sum.volume / (column.width * edge_), sum.mass / sum.volume,
                          std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z) / sum.volume, -out});
    }
    wetted_.clear();
}

}  // namespace talus::observe
