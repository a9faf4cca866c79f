#include "validate/point_mass.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus::validate {

PointMass::PointMass(Profile profile, double friction, double gravity, double x, double speed)
    : profile_(std::move(profile)),
      friction_(friction),
      gravity_(gravity),
      x_(x),
      z_(profile_(x).elevation),
      along_(speed) {}

double PointMass::speed() const {
    return flies_ ? std::hypot(vx_, vz_) : std::abs(along_);
}

void PointMass::advance_to(double time) {
    constexpr double longest = 5e-4;
    while (time_ < time - 1e-12) {
        const double step = std::min(longest, time - time_);
        if (flies_) {
            fly(step);
        } else {
            slide(step);
        }
        time_ += step;
    }
}

double PointMass::pressing(const ProfilePoint& ground, double speed) const {
    const double cosine = 1 / std::hypot(1, ground.slope);
    const double curvature = ground.bend * cosine * cosine * cosine;
    return gravity_ * cosine + curvature * speed * speed;
}

PointMass::Rates PointMass::rates(double x, double speed, double direction) const {
    const ProfilePoint ground = profile_(x);
    const double cosine = 1 / std::hypot(1, ground.slope);
    const double drive = -gravity_ * ground.slope * cosine;
    const double resistance = friction_ * std::max(0.0, pressing(ground, speed));
    if (direction == 0 && std::abs(drive) <= resistance) return {0, 0};
    return {speed * cosine, drive - std::copysign(resistance, direction != 0 ? direction : drive)};
}

void PointMass::slide(double step) {
    const ProfilePoint ground = profile_(x_);
    if (pressing(ground, along_) < 0) {
        const double cosine = 1 / std::hypot(1, ground.slope);
        vx_ = along_ * cosine;
        vz_ = along_ * cosine * ground.slope;
        flies_ = true;
        return fly(step);
    }
    const Rates a = rates(x_, along_, along_);
    const Rates b = rates(x_ + a.way * step / 2, along_ + a.speed * step / 2, along_);
    const Rates c = rates(x_ + b.way * step / 2, along_ + b.speed * step / 2, along_);
    const Rates d = rates(x_ + c.way * step, along_ + c.speed * step, along_);
    x_ += step / 6 * (a.way + 2 * b.way + 2 * c.way + d.way);
    const double next = along_ + step / 6 * (a.speed + 2 * b.speed + 2 * c.speed + d.speed);
    // Friction stops it; it does not turn it around.
    along_ = friction_ > 0 && next * along_ < 0 ? 0 : next;
    z_ = profile_(x_).elevation;
}

void PointMass::fly(double step) {
    x_ += vx_ * step;
    z_ += (vz_ - gravity_ * step / 2) * step;
    vz_ -= gravity_ * step;
    if (z_ <= profile_(x_).elevation) land();
}

void PointMass::land() {
    const ProfilePoint ground = profile_(x_);
    const double cosine = 1 / std::hypot(1, ground.slope);
    const double before = vx_ * vx_ + vz_ * vz_;
    const double blow = std::max(0.0, (vx_ * ground.slope - vz_) * cosine);
    const double along = (vx_ + vz_ * ground.slope) * cosine;
    along_ = std::copysign(std::max(0.0, std::abs(along) - friction_ * blow), along);
    landing_loss_ += (before - along_ * along_) / 2;
    z_ = ground.elevation;
    flies_ = false;
}

}  // namespace talus::validate
