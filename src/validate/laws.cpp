#include "validate/laws.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talus::validate {

double column_run_out_axisymmetric(double aspect) {
    return aspect < 1.7 ? 1.24 * aspect : 1.6 * std::sqrt(aspect);
}

double column_run_out_planar(double aspect) {
    return aspect < 2.3 ? 1.2 * aspect : 1.9 * std::cbrt(aspect * aspect);
}

ColumnHeights column_heights_axisymmetric(double aspect) {
    const double lajeunesse = std::min(aspect, 0.74);
    return {lajeunesse, aspect < 1.7 ? lajeunesse : 0.88 * std::pow(aspect, 1.0 / 6)};
}

double column_height_planar(double aspect) {
    return std::min(aspect, std::pow(aspect, 0.4));
}

DamBreak::DamBreak(double slope, double friction_angle, double depth, double gravity)
    : depth_(depth),
      normal_gravity_(gravity * std::cos(slope)),
      acceleration_(normal_gravity_ * (std::tan(slope) - std::tan(friction_angle))),
      wave_speed_(std::sqrt(normal_gravity_ * depth)) {}

double DamBreak::back(double time) const {
    return acceleration_ * time * time / 2 - wave_speed_ * time;
}

double DamBreak::front(double time) const {
    return acceleration_ * time * time / 2 + 2 * wave_speed_ * time;
}

double DamBreak::thickness(double x, double time) const {
    if (x <= back(time)) return depth_;
    if (x >= front(time)) return 0;
    const double root = 2 * wave_speed_ - x / time + acceleration_ * time / 2;
    return root * root / (9 * normal_gravity_);
}

double DamBreak::velocity(double x, double time) const {
    if (x <= back(time)) return acceleration_ * time;
    if (x >= front(time)) return 0;
    return 2.0 / 3 * (wave_speed_ + x / time + acceleration_ * time);
}

SpreadingCap::SpreadingCap(double slope, double friction_angle, double length, double height, double gravity,
                           double end)
    : length_(length),
      height_(height),
      acceleration_(std::sin(slope) - std::cos(slope) * std::tan(friction_angle)),
      time_unit_(std::sqrt(length / gravity)),
      step_(1e-4) {
    const double a = std::sin(slope), friction = std::cos(slope) * std::tan(friction_angle);
    // B and D of the source; they are equal for a cap that is as long as it is wide.
    const double spread = height / length * std::cos(slope);
    struct Derivatives {
        double g, f, g_rate, f_rate;
    };
    const auto rate = [&](double t, const Derivatives& s) {
        return Derivatives{s.g_rate, s.f_rate, 2 * spread / (s.g * s.g * s.f),
                           2 * spread / (s.g * s.f * s.f) - friction * s.f_rate / (acceleration_ * t)};
    };
    const auto moved = [](const Derivatives& s, const Derivatives& r, double by) {
        return Derivatives{s.g + by * r.g, s.f + by * r.f, s.g_rate + by * r.g_rate, s.f_rate + by * r.f_rate};
    };
    // The equations are singular at t = 0; up to 0.1 the source's series is used.
    constexpr double series_end = 0.1;
    const double e = acceleration_ / a;
    Derivatives state{1, 1, 0, 0};
    const auto last = static_cast<std::size_t>(std::ceil(end / time_unit_ / step_)) + 2;
    for (std::size_t k = 0; k <= last; ++k) {
        const double t = static_cast<double>(k) * step_;
        if (t <= series_end) {
            state = {1 + spread * t * t, 1 + spread * e * t * t, 2 * spread * t, 2 * spread * e * t};
        } else {  // Runge & Kutta, fourth order, from the step before
            const double from = t - step_;
            const Derivatives r1 = rate(from, state);
            const Derivatives r2 = rate(from + step_ / 2, moved(state, r1, step_ / 2));
            const Derivatives r3 = rate(from + step_ / 2, moved(state, r2, step_ / 2));
            const Derivatives r4 = rate(t, moved(state, r3, step_));
            state = moved(moved(moved(moved(state, r1, step_ / 6), r2, step_ / 3), r3, step_ / 3), r4, step_ / 6);
        }
        shapes_.push_back({state.g, state.f});
    }
}

SpreadingCap::Shape SpreadingCap::shape_at(double time) const {
    const double at = std::clamp(time / time_unit_ / step_, 0.0, static_cast<double>(shapes_.size() - 2));
    const auto k = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(k);
    const Shape &a = shapes_[k], &b = shapes_[k + 1];
    return {a.along + share * (b.along - a.along), a.across + share * (b.across - a.across)};
}

double SpreadingCap::travelled(double time) const {
    const double t = time / time_unit_;
    return length_ * acceleration_ * t * t / 2;
}

double SpreadingCap::half_length(double time) const {
    return length_ * shape_at(time).along;
}

double SpreadingCap::half_width(double time) const {
    return length_ * shape_at(time).across;
}

double SpreadingCap::thickness(double along, double across, double time) const {
    const Shape shape = shape_at(time);
    const double xi = (along - travelled(time)) / (length_ * shape.along), eta = across / (length_ * shape.across);
    return std::max(0.0, height_ / (shape.along * shape.across) * (1 - xi * xi - eta * eta));
}

double momentum_jump(double froude) {
    double low = 1, high = 2 + 2 * froude;  // (x - 1)(x^2 - 1) > 2 Fr^2 x there
    for (int bisection = 0; bisection < 100; ++bisection) {
        const double x = (low + high) / 2;
        ((x - 1) * (x * x - 1) < 2 * froude * froude * x ? low : high) = x;
    }
    return (low + high) / 2;
}

double SheetFlow::with_drag(double friction, double turbulent_friction, double viscosity) const {
    const double driving = gravity * (std::sin(slope) - friction * std::cos(slope));
    if (driving <= 0) return 0;
    const double linear = 3 * viscosity / (thickness * thickness);
    const double square = turbulent_friction > 0 ? gravity / (turbulent_friction * thickness) : 0;
    return 2 * driving / (linear + std::sqrt(linear * linear + 4 * square * driving));
}

double SheetFlow::with_samosat(double friction, double fluidization, double drag) const {
    // (g h sin - f N - drag w) (R_s0 N + w) = f N R_s0 N, of w = v^2 and N = g h cos.
    const double normal = gravity * thickness * std::cos(slope), scale = fluidization * normal;
    const double driving = gravity * thickness * std::sin(slope) - friction * normal;
    const double linear = driving / drag - scale,
                 root = linear * linear + 4 * scale * (driving - friction * normal) / drag;
    if (driving <= 0 || root < 0) return 0;
    return std::sqrt(std::max(0.0, (linear + std::sqrt(root)) / 2));
}

double SheetFlow::bingham(double height, double yield, double viscosity) const {
    const double drive = gravity * std::sin(slope);
    const double sheared = std::max(0.0, thickness - yield / drive), z = std::min(height, sheared);
    return drive / viscosity * (sheared * z - z * z / 2);
}

double SheetFlow::bagnold(double height, double slow_friction, double fast_friction, double half_number, double grain,
                          double solid_share) const {
    const double tangent = std::tan(slope);
    if (!(tangent > slow_friction) || !(tangent < fast_friction)) return std::numeric_limits<double>::quiet_NaN();
    const double number = half_number * (tangent - slow_friction) / (fast_friction - tangent);
    return 2.0 / 3 * number / grain * std::sqrt(solid_share * gravity * std::cos(slope)) *
           (std::pow(thickness, 1.5) - std::pow(thickness - std::min(height, thickness), 1.5));
}

}  // namespace talus::validate
