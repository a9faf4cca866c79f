#include "stats/prediction_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace talus::stats {

namespace {

constexpr double label_doubt = 0.5;  // standard deviation half way between the labels

}  // namespace

PredictionEmulator PredictionEmulator::fit(const Points& points, const std::vector<double>& values, double unreached) {
    return fit(nullptr, points, values, unreached);
}

PredictionEmulator PredictionEmulator::fit_beside(const PredictionEmulator& fast, const Points& points,
                                                  const std::vector<double>& values) {
    return fit(&fast, points, values, fast.unreached_);
}

PredictionEmulator PredictionEmulator::fit(const PredictionEmulator* fast, const Points& points,
                                           const std::vector<double>& values, double unreached) {
    PredictionEmulator made;
    made.unreached_ = unreached;
    Points reached;
    std::vector<double> given, labels;
    for (std::size_t i = 0; i < points.size(); ++i) {
        labels.push_back(std::isfinite(values[i]) ? 1 : -1);
        if (!std::isfinite(values[i])) continue;
        reached.push_back(points[i]);
        given.push_back(values[i]);
    }
    const auto emulate = [&](const std::optional<Emulator> PredictionEmulator::*part, Points at,
                             const std::vector<double>& of) {
        if (fast == nullptr || !(fast->*part)) return Emulator::fit(std::move(at), of);
        return Emulator::fit_beside(std::make_shared<const Emulator>(*(fast->*part)), std::move(at), of);
    };
    const bool fast_reaches = fast != nullptr && fast->value_;
    if (!given.empty() || fast_reaches) {
        made.value_ = emulate(&PredictionEmulator::value_, std::move(reached), given);
        const bool unsure = given.size() < points.size() || (fast != nullptr && fast->reach_);
        if (unsure) made.reach_ = emulate(&PredictionEmulator::reach_, points, labels);
    }
    return made;
}

double PredictionEmulator::reached_at(const std::vector<double>& point) const {
    if (!reach_) return value_ ? 1 : 0;
    // Least-squares classification (Rasmussen & Williams 2006, section 6.5), read as a probability. A smooth function
    // is overconfident next to a step: values between 1 and -1 are treated as uncertain.
    const Emulator::Estimate label = reach_->at(point);
    const double doubt = label_doubt * label_doubt * std::max(0.0, 1 - label.mean * label.mean);
    const double deviation = std::sqrt(label.variance + label.noise + doubt);
    return 0.5 * std::erfc(-label.mean / deviation / std::numbers::sqrt2);
}

PredictionEmulator::Estimate PredictionEmulator::at(const std::vector<double>& point) const {
    return {reached_at(point), value_ ? value_->at(point) : Emulator::Estimate{unreached_, 0, 0}};
}

double PredictionEmulator::mean_at(const std::vector<double>& point) const {
    return value_ ? value_->mean_at(point) : unreached_;
}

PredictionEmulator PredictionEmulator::believing(const std::vector<double>& point) const {
    PredictionEmulator more = *this;
    if (value_ && reached_at(point) > 0.5) more.value_ = value_->with(point, value_->mean_at(point));
    if (reach_) more.reach_ = reach_->with(point, reach_->mean_at(point));
    return more;
}

double PredictionEmulator::reach_told() const {
    if (!reach_) return 1;
    double right = 0, count = 0;
    for (const Emulator::LeftOut& run : reach_->leave_one_out()) {
        right += run.computed * run.mean > 0 ? 1 : 0;
        ++count;
    }
    return right / count;
}

}  // namespace talus::stats
