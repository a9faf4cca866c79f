#include "observe/barrier_line.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/barrier.hpp"

namespace talus::observe {

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

BarrierLine::BarrierLine(const terrain::Terrain& terrain, const params::BarrierSpec& shape)
    : half_thickness_(shape.thickness / 2) {
    const WorldPoint& origin = terrain.frame().origin;
    for (const PlanPoint& p : shape.line) {
        const PlanPoint local{p.x - origin.x, p.y - origin.y};
        if (points_.empty()) extent_ = {local.x, local.y, local.x, local.y};
        extent_.include(local);
        points_.push_back({static_cast<float>(local.x), static_cast<float>(local.y)});
    }
    length_ = terrain::length_of(points_);
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
}

BarrierLine::Crossing BarrierLine::crossing(const PlanPoint& a, const PlanPoint& b) const {
    const auto cross = [](const PlanPoint& p, const PlanPoint& q, const PlanPoint& r) {
        return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    };
    Crossing found;
    double chainage = 0;
    for (std::size_t k = 0; k + 1 < points_.size(); ++k) {
        const PlanPoint &p = points_[k], &q = points_[k + 1];
        const double length = std::hypot(q.x - p.x, q.y - p.y);
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

BarrierLine::Place BarrierLine::place_of(const PlanPoint& p) const {
    Place place;
    place.distance = std::numeric_limits<double>::infinity();
    double chainage = 0;
    for (std::size_t k = 0; k + 1 < points_.size(); ++k) {
        const PlanPoint& from = points_[k];
        const double dx = points_[k + 1].x - from.x, dy = points_[k + 1].y - from.y;
        const double length = std::hypot(dx, dy), along = ((p.x - from.x) * dx + (p.y - from.y) * dy) / length;
        const double across = (dx * (p.y - from.y) - dy * (p.x - from.x)) / length;
        // Outside a bend, the position may be beside neither segment.
        const double past = std::max({0.0, -along, along - length});
        const bool at_end = (k == 0 && along < 0) || (k + 2 == points_.size() && along > length);
        const double distance = std::hypot(across, past);
        if (!at_end && distance < place.distance) {
            place = {chainage + std::clamp(along, 0.0, length), distance, across > 0 ? 1 : -1};
        }
        chainage += length;
    }
    return place;
}

double BarrierLine::opening_crest(double chainage) const {
    double crest = -std::numeric_limits<double>::infinity();
    for (const Opening& opening : openings_) {
        if (chainage > opening.from && chainage < opening.to) crest = std::max(crest, opening.crest);
    }
    return crest;
}

}  // namespace talus::observe
