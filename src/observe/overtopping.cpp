#include "observe/overtopping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "observe/retention.hpp"
#include "sim/physics/net.hpp"
#include "terrain/barrier.hpp"

namespace talus::observe {
Overtopping::Overtopping(const sim::Model& model, const terrain::Terrain& terrain, const params::BarrierSpec& shape,
                         double deposited_speed)
    : line_(terrain, shape),
      particle_volume_(model.particle_volume()),
      section_(4 * model.particle_spacing),
      deposited_speed_(deposited_speed) {
    if (shape.passing_share) {
        passing_share_ = static_cast<float>(*shape.passing_share);
        const double length = terrain::length_of(shape.line);
        for (double chainage = 0; chainage < length + 1; ++chainage) {
            const double ground = terrain.elevation_at(point_at(shape.line, std::min(chainage, length)));
            crest_.push_back(shape.crest_elevation.value_or(ground + shape.height.value_or(0)) -
                             terrain.frame().origin.z);
        }
    }
    // No particle moves farther in a step than a few spacings.
    near_ = line_.extent().grown(std::max(2.0, 4 * model.particle_spacing));
}

bool Overtopping::in_mesh(std::uint32_t id, double chainage, double z) const {
    if (crest_.empty() || !(sim::grain_rank(id) < passing_share_)) return false;
    return z < crest_[std::min(static_cast<std::size_t>(std::max(0.0, chainage)), crest_.size() - 1)];
}

void Overtopping::after_step(const Debris& debris, bool jumped) {
    if (jumped) {
        for (Track& track : tracks_) track.step = 0;
    }
    ++calls_;
    const sim::StateSummary& state = debris.summary();
    if (tracks_.size() < state.seeded) tracks_.resize(state.seeded);
    const auto rounded = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    debris.find_inside({rounded(near_.x_min), rounded(near_.y_min), rounded(near_.x_max), rounded(near_.y_max)}, false,
                       inside_);
    for (const PlacedParticle& particle : inside_) {
        const Point now{particle.position.x, particle.position.y};
        Track& track = tracks_[particle.id];
        const bool known = track.step == calls_;
        const Point before = track.last;
        track.last = now;
        track.step = calls_ + 1;
        if (!known || (before.x == now.x && before.y == now.y)) continue;
        const BarrierLine::Crossing crossed = line_.crossing({before.x, before.y}, {now.x, now.y});
        if (crossed.net == 0) continue;
        Side& was = track.through ? through_ : over_;
        was.to_right -= track.net > 0;
        was.to_left -= track.net < 0;
        track.net = static_cast<std::int8_t>(std::clamp(track.net + crossed.net, -1, 1));
        const double z = particle.position.z;
        track.through = z < line_.opening_crest(crossed.chainage) || in_mesh(particle.id, crossed.chainage, z);
        Side& is = track.through ? through_ : over_;
        is.to_right += track.net > 0;
        is.to_left += track.net < 0;
        if (std::isnan(first_time_) && !track.through) first_time_ = state.time;
    }
}

/// In the direction with the larger total volume.
double Overtopping::beyond(const Side& counted) const {
    const std::int64_t all = over_.to_right + through_.to_right - over_.to_left - through_.to_left;
    const std::int64_t net = counted.to_right - counted.to_left;
    return static_cast<double>(std::max<std::int64_t>(0, all < 0 ? -net : net)) * particle_volume_;
}

/// On one side of the line, in bins two spacings wide, so that debris a particle thick has no gaps.
std::vector<DebrisColumn> Overtopping::columns_of(const std::vector<PlacedParticle>& particles, int side) const {
    const double size = section_ / 2, half_spacing = section_ / 8;
    struct Placed {
        std::int32_t row, column;
        float z, speed, distance;
    };
    std::vector<Placed> all;
    for (const PlacedParticle& particle : particles) {
        const LocalPoint& p = particle.position;
        const BarrierLine::Place place = line_.place_of({p.x, p.y});
        // What lies on its crest is not behind it.
        if (place.side != side || place.distance < line_.half_thickness()) continue;
        all.push_back({static_cast<std::int32_t>(std::floor(p.y / size)),
                       static_cast<std::int32_t>(std::floor(p.x / size)), p.z, particle.speed,
                       static_cast<float>(place.distance - line_.half_thickness())});
    }
    // Wholly in order, so that sums do not depend on the order of the particles.
    std::sort(all.begin(), all.end(), [](const Placed& a, const Placed& b) {
        return std::tie(a.row, a.column, a.z, a.speed, a.distance) <
               std::tie(b.row, b.column, b.z, b.speed, b.distance);
    });
    std::vector<DebrisColumn> columns;
    for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
        double speed = 0, nearest = all[first].distance;
        for (; last < all.size() && all[last].row == all[first].row && all[last].column == all[first].column; ++last) {
            speed += all[last].speed;
            nearest = std::min(nearest, double{all[last].distance});
        }
        const auto count = static_cast<double>(last - first);
        const double volume = count * particle_volume_, bottom = all[first].z - half_spacing;
        columns.push_back({all[first].column, all[first].row, volume, bottom, bottom + volume / (size * size),
                           speed < count * deposited_speed_, nearest < size});
    }
    return columns;
}

Overtopping::Filling Overtopping::filling(const Debris& debris) const {
    std::vector<PlacedParticle> around;
    debris.find_inside(near_.grown(line_.half_thickness()), true, around);
    const auto sections = static_cast<std::size_t>(std::max(1.0, std::floor(line_.length() / section_)));
    std::array<std::vector<std::int64_t>, 2> at_face;  // left, right; by section
    for (auto& side : at_face) side.resize(sections);
    bool touches = false;
    for (const PlacedParticle& particle : around) {
        const BarrierLine::Place place = line_.place_of({particle.position.x, particle.position.y});
        const double off = place.distance - line_.half_thickness();
        if (place.side == 0 || off < 0 || off >= section_) continue;
        touches = true;
        const auto section = static_cast<std::size_t>(place.chainage / line_.length() * static_cast<double>(sections));
        ++at_face.at(place.side > 0 ? 0 : 1)[std::min(section, sections - 1)];
    }
    if (!touches) return {};
    constexpr double everywhere = 1e9;
    debris.find_inside({-everywhere, -everywhere, everywhere, everywhere}, true, around);
    const double on_left = retained_volume(columns_of(around, 1)), on_right = retained_volume(columns_of(around, -1));
    const std::int64_t gone = over_.to_right + through_.to_right - over_.to_left - through_.to_left;
    const bool left = gone != 0 ? gone > 0 : on_left >= on_right;
    const auto& upstream = at_face.at(left ? 0 : 1);
    const double area = section_ * line_.length() / static_cast<double>(sections);
    return {left ? on_left : on_right,
            static_cast<double>(*std::max_element(upstream.begin(), upstream.end())) * particle_volume_ / area};
}

}  // namespace talus::observe
