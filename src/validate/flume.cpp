#include "validate/flume.hpp"

#include <algorithm>
#include <cmath>

namespace talus::validate {

FlumeBed::FlumeBed(const FlumeShape& shape, const std::optional<FlumeRamp>& ramp) : points_(count) {
    PlanPoint p{};
    for (std::size_t k = 0; k < points_.size(); ++k) {
        points_[k] = p;
        const double s = place(k), bent = (s - shape.bend_start) / (shape.bend_end - shape.bend_start);
        double fall = shape.slope + std::clamp(bent, 0.0, 1.0) * (shape.pad_slope - shape.slope);
        if (ramp && s > ramp->foot) fall = -ramp->angle;
        p = {p.x + step * std::cos(fall), p.y - step * std::sin(fall)};
    }
    middle_ = (points_.front().x + points_.back().x) / 2;
}

PlanPoint FlumeBed::at(double s) const {
    const double u = std::clamp((s - first) / step, 0.0, static_cast<double>(points_.size()) - 1.001);
    const auto k = static_cast<std::size_t>(u);
    const double t = u - static_cast<double>(k);
    const PlanPoint &a = points_[k], &b = points_[k + 1];
    return {a.x + t * (b.x - a.x) - middle_, a.y + t * (b.y - a.y)};
}

double FlumeBed::along(double x) const {
    const auto next = std::lower_bound(points_.begin(), points_.end(), x + middle_,
                                       [](const PlanPoint& p, double value) { return p.x < value; });
    const auto k = std::clamp<std::ptrdiff_t>(next - points_.begin(), 1, static_cast<std::ptrdiff_t>(count) - 1);
    const PlanPoint &a = points_[static_cast<std::size_t>(k - 1)], &b = points_[static_cast<std::size_t>(k)];
    return place(static_cast<std::size_t>(k - 1)) + step * (x + middle_ - a.x) / (b.x - a.x);
}

FlumeFill::FlumeFill(const FlumeShape& shape, const FlumeBed& bed) : bed_(bed) {
    const PlanPoint foot = bed.at(0), crest{foot.x, foot.y + shape.gate_height};
    const PlanPoint edge{crest.x - shape.top_length * std::cos(shape.top_slope),
                         crest.y + shape.top_length * std::sin(shape.top_slope)};
    const double sine = std::sin(shape.slope), cosine = std::cos(shape.slope);
    const auto along = [&](const PlanPoint& p) { return (p.x - foot.x) * cosine - (p.y - foot.y) * sine; };
    const auto normal = [&](const PlanPoint& p) { return (p.x - foot.x) * sine + (p.y - foot.y) * cosine; };
    const double at_gate = 0.5 * normal(crest) * -along(crest);
    const double below_top = 0.5 * (normal(crest) + normal(edge)) * (along(crest) - along(edge));
    const double rest = shape.volume / shape.width - at_gate - below_top;
    edge_ = along(edge);
    back_ = edge_ - 2 * rest / normal(edge);
    height_ = normal(crest);
    surface_ = {bed.at(back_), edge, crest};
}

double FlumeFill::top(double x) const {
    for (std::size_t k = 1; k < surface_.size(); ++k) {
        const PlanPoint &a = surface_[k - 1], &b = surface_[k];
        if (x >= a.x && x <= b.x) return a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
    }
    return bed_.at(bed_.along(x)).y;
}

}  // namespace talus::validate
