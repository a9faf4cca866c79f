#include "twin/overtopping.hpp"

#include <algorithm>
#include <cmath>

namespace talus::twin {

Overtopping::Overtopping(const Model& model, const std::vector<PlanPoint>& line, double height)
    : particle_volume_(model.particle_volume()), reach_(5 * height) {
    const WorldPoint& origin = model.terrain.frame().origin;
    for (const PlanPoint& p : line) {
        const PlanPoint local{p.x - origin.x, p.y - origin.y};
        if (line_.empty()) near_ = {local.x, local.y, local.x, local.y};
        near_.include(local);
        line_.push_back({static_cast<float>(local.x), static_cast<float>(local.y)});
    }
    // Nothing moves farther in a step than a few spacings.
    near_ = near_.grown(std::max(2.0, 4 * model.particle_spacing));
}

int Overtopping::crossings(const Point& a, const Point& b) const {
    const auto cross = [](const Point& p, const Point& q, const Point& r) {
        return (static_cast<double>(q.x) - p.x) * (static_cast<double>(r.y) - p.y) -
               (static_cast<double>(q.y) - p.y) * (static_cast<double>(r.x) - p.x);
    };
    int net = 0;
    for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
        const Point &p = line_[k], &q = line_[k + 1];
        // A point on the line counts as to its right; a bend belongs to the segment that begins there.
        const bool left_before = cross(p, q, a) > 0, left_now = cross(p, q, b) > 0;
        if (left_before == left_now) continue;
        const bool begin_side = cross(a, b, p) > 0, end_side = cross(a, b, q) > 0;
        if (begin_side == end_side) continue;
        net += left_before ? 1 : -1;
    }
    return net;
}

void Overtopping::after_step(const State& state, bool jumped) {
    if (jumped) {
        for (Track& track : tracks_) track.step = 0;
    }
    ++calls_;
    if (tracks_.size() < state.seeded) tracks_.resize(state.seeded);
    const auto x_min = static_cast<float>(near_.x_min), x_max = static_cast<float>(near_.x_max);
    const auto y_min = static_cast<float>(near_.y_min), y_max = static_cast<float>(near_.y_max);
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const Point now{state.position.x[i], state.position.y[i]};
        if (!(now.x >= x_min && now.x <= x_max && now.y >= y_min && now.y <= y_max)) continue;
        Track& track = tracks_[state.id[i]];
        const bool known = track.step == calls_;
        const Point before = track.last;
        track.last = now;
        track.step = calls_ + 1;
        if (!known || (before.x == now.x && before.y == now.y)) continue;
        const int crossed = crossings(before, now);
        if (crossed == 0) continue;
        to_right_ -= track.net > 0;
        to_left_ -= track.net < 0;
        track.net = static_cast<std::int8_t>(std::clamp(track.net + crossed, -1, 1));
        to_right_ += track.net > 0;
        to_left_ += track.net < 0;
        if (std::isnan(first_time_)) first_time_ = state.time;
    }
}

double Overtopping::volume() const {
    return static_cast<double>(std::abs(to_right_ - to_left_)) * particle_volume_;
}

double Overtopping::held_volume(const State& state) const {
    const Extent within = near_.grown(reach_);
    std::int64_t left = 0, right = 0;
    for (std::uint32_t i = 0; i < state.count; ++i) {
        const double x = state.position.x[i], y = state.position.y[i];
        if (!within.contains({x, y}) || state.held[i] != 0) continue;
        double nearest = reach_;
        int side = 0;
        for (std::size_t k = 0; k + 1 < line_.size(); ++k) {
            const double px = line_[k].x, py = line_[k].y, dx = line_[k + 1].x - px, dy = line_[k + 1].y - py;
            const double length = std::hypot(dx, dy), along = ((x - px) * dx + (y - py) * dy) / length;
            const double across = (dx * (y - py) - dy * (x - px)) / length;
            // At the outside of a bend neither segment has the position beside it.
            const double beyond = std::max({0.0, -along, along - length});
            const bool at_end = (k == 0 && along < 0) || (k + 2 == line_.size() && along > length);
            const double distance = std::hypot(across, beyond);
            if (at_end || distance >= nearest) continue;
            nearest = distance;
            side = across > 0 ? 1 : -1;
        }
        left += side > 0;
        right += side < 0;
    }
    if (to_right_ != to_left_) return static_cast<double>(to_right_ > to_left_ ? left : right) * particle_volume_;
    return static_cast<double>(std::max(left, right)) * particle_volume_;
}

}  // namespace talus::twin
