#include "observe/overtopping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/physics/net.hpp"
#include "terrain/barrier.hpp"

namespace talus::observe {
namespace {

/// Highest ground under the line, world.
double highest_ground(const terrain::Terrain& terrain, const std::vector<PlanPoint>& line) {
    double highest = -std::numeric_limits<double>::infinity();
    for (const PlanPoint& p : line) highest = std::max(highest, terrain.elevation_at(p));
    return highest;
}

PlanPoint point_at(const std::vector<PlanPoint>& line, double chainage) {
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const PlanPoint &a = line[k], &b = line[k + 1];
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        if (chainage <= length || k + 2 == line.size()) {
            const double share = chainage / length;
            return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
        }
        chainage -= length;
    }
    return line.back();
}

}  // namespace

Overtopping::Overtopping(const sim::Model& model, const terrain::Terrain& terrain, const params::BarrierSpec& shape)
    : particle_volume_(model.particle_volume()),
      section_(4 * model.particle_spacing),
      half_thickness_(shape.thickness / 2) {
    const WorldPoint& origin = terrain.frame().origin;
    const double height =
        shape.crest_elevation ? *shape.crest_elevation - highest_ground(terrain, shape.line) : shape.height.value_or(0);
    reach_ = std::max(5 * height, half_thickness_ + section_);
    for (const PlanPoint& p : shape.line) {
        const PlanPoint local{p.x - origin.x, p.y - origin.y};
        if (line_.empty()) near_ = {local.x, local.y, local.x, local.y};
        near_.include(local);
        line_.push_back({static_cast<float>(local.x), static_cast<float>(local.y)});
    }
    for (const params::BarrierOpeningSpec& opening : shape.openings) {
        const double ground = terrain.elevation_at(point_at(shape.line, opening.position));
        openings_.push_back({opening.position - opening.width / 2, opening.position + opening.width / 2,
                             shape.crest_elevation.value_or(ground + shape.height.value_or(0)) - origin.z});
    }
    if (shape.clearance) {  // the gap below follows the ground: a row of openings, a metre wide each
        const double length = terrain::length_of(shape.line);
        for (double chainage = 0; chainage < length; ++chainage) {
            const double ground = terrain.elevation_at(point_at(shape.line, std::min(chainage + 0.5, length)));
            openings_.push_back({chainage - 1e-3, chainage + 1, ground + *shape.clearance - origin.z});
        }
    }
    if (shape.passing_share) {
        passing_share_ = static_cast<float>(*shape.passing_share);
        const double length = terrain::length_of(shape.line);
        for (double chainage = 0; chainage < length + 1; ++chainage) {
            const double ground = terrain.elevation_at(point_at(shape.line, std::min(chainage, length)));
            crest_.push_back(shape.crest_elevation.value_or(ground + shape.height.value_or(0)) - origin.z);
        }
    }
    // No particle moves farther in a step than a few spacings.
    near_ = near_.grown(std::max(2.0, 4 * model.particle_spacing));
}

Overtopping::Crossing Overtopping::crossing(const Point& a, const Point& b) const {
    const auto cross = [](const Point& p, const Point& q, const Point& r) {
        return (static_cast<double>(q.x) - p.x) * (static_cast<double>(r.y) - p.y) -
               (static_cast<double>(q.y) - p.y) * (static_cast<double>(r.x) - p.x);
    };
    Crossing found;
    double chainage = 0;
    for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
        const Point &p = line_[k], &q = line_[k + 1];
        const double length = std::hypot(static_cast<double>(q.x) - p.x, static_cast<double>(q.y) - p.y);
        // A point on the line counts as to its right; a bend belongs to the segment that begins there.
        const bool left_before = cross(p, q, a) > 0, left_now = cross(p, q, b) > 0;
        const double at_begin = cross(a, b, p), at_end = cross(a, b, q);
        if (left_before != left_now && (at_begin > 0) != (at_end > 0)) {
            found.net += left_before ? 1 : -1;
            found.chainage = chainage + length * at_begin / (at_begin - at_end);
        }
        chainage += length;
    }
    return found;
}

bool Overtopping::in_opening(double chainage, double z) const {
    return std::any_of(openings_.begin(), openings_.end(), [&](const Opening& opening) {
        return chainage > opening.from && chainage < opening.to && z < opening.crest;
    });
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
        const Crossing crossed = crossing(before, now);
        if (crossed.net == 0) continue;
        Side& was = track.through ? through_ : over_;
        was.to_right -= track.net > 0;
        was.to_left -= track.net < 0;
        track.net = static_cast<std::int8_t>(std::clamp(track.net + crossed.net, -1, 1));
        const double z = particle.position.z;
        track.through = in_opening(crossed.chainage, z) || in_mesh(particle.id, crossed.chainage, z);
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

Overtopping::Place Overtopping::place_of(double x, double y) const {
    Place place;
    place.distance = reach_;
    double chainage = 0;
    for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
        const double px = line_[k].x, py = line_[k].y, dx = line_[k + 1].x - px, dy = line_[k + 1].y - py;
        const double length = std::hypot(dx, dy), along = ((x - px) * dx + (y - py) * dy) / length;
        const double across = (dx * (y - py) - dy * (x - px)) / length;
        // Outside a bend, the position may be beside neither segment.
        const double past = std::max({0.0, -along, along - length});
        const bool at_end = (k == 0 && along < 0) || (k + 2 == line_.size() && along > length);
        const double distance = std::hypot(across, past);
        if (!at_end && distance < place.distance) {
            place = {chainage + std::clamp(along, 0.0, length), distance, across > 0 ? 1 : -1};
        }
        chainage += length;
    }
    return place;
}

Overtopping::Filling Overtopping::filling(const Debris& debris) const {
    double length = 0;
    for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
        length += std::hypot(static_cast<double>(line_[k + 1].x) - line_[k].x,
                             static_cast<double>(line_[k + 1].y) - line_[k].y);
    }
    const auto sections = static_cast<std::size_t>(std::max(1.0, std::floor(length / section_)));
    struct Beside {
        std::int64_t particles = 0;
        std::vector<std::int64_t> at_face;  // by section
    };
    std::array<Beside, 2> sides;  // left, right
    for (Beside& side : sides) side.at_face.resize(sections);
    std::vector<PlacedParticle> around;
    debris.find_inside(near_.grown(reach_), true, around);
    for (const PlacedParticle& particle : around) {
        const double x = particle.position.x, y = particle.position.y;
        const Place place = place_of(x, y);
        if (place.side == 0) continue;
        Beside& side = sides[place.side > 0 ? 0 : 1];
        ++side.particles;
        if (place.distance < half_thickness_ || place.distance >= half_thickness_ + section_) continue;
        const auto section = static_cast<std::size_t>(place.chainage / length * static_cast<double>(sections));
        ++side.at_face[std::min(section, sections - 1)];
    }
    const std::int64_t gone = over_.to_right + through_.to_right - over_.to_left - through_.to_left;
    const bool left = gone != 0 ? gone > 0 : sides[0].particles >= sides[1].particles;
    const Beside& upstream = sides[left ? 0 : 1];
    const double area = section_ * length / static_cast<double>(sections);
    const auto deepest = *std::max_element(upstream.at_face.begin(), upstream.at_face.end());
    return {static_cast<double>(upstream.particles) * particle_volume_,
            static_cast<double>(deepest) * particle_volume_ / area};
}

}  // namespace talus::observe
