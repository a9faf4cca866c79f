#include "products/tracks.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "products/csv.hpp"
#include "products/text_file.hpp"
#include "scene/particle_spacing.hpp"

namespace talus::products {

Tracks::Tracks(const scene::Scene& scene) : scene_(scene) {
    // Ids count particles as they come, those of a release in the order in which it is filled.
    const double particles = scene::total_volume(scene) / std::pow(scene::particle_spacing(scene), 3);
    stride_ = static_cast<std::uint32_t>(std::clamp(std::floor(particles / scene.spec.outputs.tracks), 1.0, 4e9));
}

void Tracks::add(const run::Frame& frame) {
    if (frame.particles == nullptr) return;
    const sim::State& state = *frame.particles;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        if (state.id[i] % stride_ != 0) continue;
        const LocalPoint p = state.position.at(i);
        const WorldPoint at = frame.frame->to_world(p);
        places_[state.id[i]].push_back({frame.time, at, static_cast<double>(length(state.velocity.at(i)))});
    }
}

Status Tracks::write(const std::filesystem::path& folder) const {
    Csv csv("particle,time_s,x_m,y_m,z_m,speed_mps");
    std::vector<geo::OutputFeature> features;
    for (const auto& [id, places] : places_) {
        geo::OutputFeature line;
        double way = 0, greatest_speed = 0;
        for (std::size_t k = 0; k < places.size(); ++k) {
            const Place& place = places[k];
            csv.row({static_cast<double>(id), place.time, place.at.x, place.at.y, place.at.z, place.speed});
            line.line.push_back({place.at.x, place.at.y});
            line.z.push_back(place.at.z);
            line.m.push_back(place.time);
            greatest_speed = std::max(greatest_speed, place.speed);
            if (k > 0) way += std::hypot(place.at.x - places[k - 1].at.x, place.at.y - places[k - 1].at.y);
        }
        if (places.size() < 2) continue;  // a line needs two
        line.values = {static_cast<double>(id), places.front().time, places.back().time, way, greatest_speed};
        features.push_back(std::move(line));
    }
    TALUS_TRY(write_text_file(folder / "tracks.csv", csv.text()));
    return write_geopackage_layer((folder / "tracks.gpkg").string(), "tracks",
                                  {{"particle"}, {"begin_s"}, {"end_s"}, {"length_m"}, {"greatest_speed_mps"}},
                                  features, scene_.crs);
}

}  // namespace talus::products
