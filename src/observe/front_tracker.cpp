#include "observe/front_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "sim/cpu/parallel.hpp"

namespace talus {

std::uint32_t front_particle_count(const State& state) {
    const auto share = static_cast<std::uint32_t>(std::ceil(0.001 * state.seeded));
    return std::max(1U, std::min(state.seeded, std::max(5U, share)));
}

FrontTracker::FrontTracker(const Model& model, const State& state, FlowPath flow_path, double chainage_interval,
                           double velocity_window)
    : flow_path_(std::move(flow_path)),
      interval_(chainage_interval),
      window_(velocity_window),
      head_length_(std::max(2 * model.support_radius, chainage_interval)),
      front_count_(front_particle_count(state)) {
    if (flow_path_.empty()) return;
    chainage_.resize(state.count);
    candidates_.reserve(state.count);
    const auto bins = static_cast<std::size_t>(flow_path_.length() / interval_) + 1;
    arrival_.assign(bins, never);
    speed_.assign(bins, never);
    held_ = find_front(model, state);
    farthest_ = current_;
}

std::uint32_t FrontTracker::locate_particles(const Model& model, const State& state, double from) {
    chainage_.resize(state.count);  // never grows: particles only leave
    const WorldPoint& origin = model.terrain.frame().origin;
    return cpu::reduce_ranges(
        state.count, 1024, std::uint32_t{0},
        [&](std::size_t first, std::size_t last, std::uint32_t held) {
            for (std::size_t i = first; i < last; ++i) {
                chainage_[i] = -1;
                if (state.held[i] != 0) {
                    ++held;
                    continue;
                }
                const PlanPoint p{origin.x + state.position.x[i], origin.y + state.position.y[i]};
                const float bound = flow_path_.chainage_bound(p);
                if (bound < 0 || bound < from) continue;
                if (const auto at = flow_path_.locate(p)) chainage_[i] = static_cast<float>(at->chainage);
            }
            return held;
        },
        std::plus<>{});
}

std::uint32_t FrontTracker::find_front(const Model& model, const State& state) {
    std::uint32_t held = 0;
    const auto collect = [&](double from) {
        held = locate_particles(model, state, from);
        candidates_.clear();
        for (const float c : chainage_) {
            if (c >= 0 && c >= from) candidates_.push_back(c);
        }
        return candidates_.size() >= front_count_;
    };
    // The front hardly moves within a step: debris well behind where it was need not be located.
    const double nearly = std::isnan(current_) ? 0 : std::max(0.0, current_ - head_length_);
    if (collect(nearly) || (nearly > 0 && collect(0))) {
        const auto front = candidates_.begin() + static_cast<std::ptrdiff_t>(front_count_) - 1;
        std::nth_element(candidates_.begin(), front, candidates_.end(), std::greater<>{});
        current_ = *front;
    } else {
        current_ = never;
    }
    return held;
}

double FrontTracker::speed_behind(double front, const State& state) const {
    const auto from = static_cast<float>(std::max(0.0, front - head_length_));
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < chainage_.size(); ++i) {
        if (chainage_[i] < from) continue;
        sum += length(state.velocity.at(i));
        ++count;
    }
    return sum / static_cast<double>(count);
}

void FrontTracker::after_step(const Model& model, const State& state) {
    if (flow_path_.empty()) return;
    const double before = current_;
    const std::uint32_t held = find_front(model, state);
    const bool release_started = held != held_;
    held_ = held;
    if (std::isnan(current_) || current_ <= farthest_) return;
    if (std::isnan(farthest_) || release_started) {
        farthest_ = current_;
        return;
    }
    const double from = std::isnan(before) ? farthest_ : before;
    double speed = never;
    for (auto bin = static_cast<std::size_t>(farthest_ / interval_) + 1;
         bin < arrival_.size() && static_cast<double>(bin) * interval_ <= current_; ++bin) {
        const double share = (static_cast<double>(bin) * interval_ - from) / (current_ - from);
        arrival_[bin] = state.time - state.time_step * (1 - share);
        if (std::isnan(speed)) speed = speed_behind(current_, state);
        speed_[bin] = speed;
    }
    farthest_ = current_;
}

double FrontTracker::fitted_velocity(std::size_t middle) const {
    const auto half = static_cast<std::size_t>(std::max(1.0, std::floor(window_ / 2 / interval_)));
    const std::size_t first = middle > half ? middle - half : 0;
    const std::size_t last = std::min(middle + half, arrival_.size() - 1);
    double count = 0, mean_time = 0, mean_chainage = 0;
    for (std::size_t bin = first; bin <= last; ++bin) {
        if (std::isnan(arrival_[bin])) continue;
        count += 1;
        mean_time += arrival_[bin];
        mean_chainage += static_cast<double>(bin) * interval_;
    }
    mean_time /= count;
    mean_chainage /= count;
    double covariance = 0, variance = 0;
    for (std::size_t bin = first; bin <= last; ++bin) {
        if (std::isnan(arrival_[bin])) continue;
        const double t = arrival_[bin] - mean_time;
        covariance += t * (static_cast<double>(bin) * interval_ - mean_chainage);
        variance += t * t;
    }
    return variance > 0 ? covariance / variance : never;
}

std::vector<FrontSample> FrontTracker::samples() const {
    std::vector<FrontSample> samples;
    for (std::size_t bin = 0; bin < arrival_.size(); ++bin) {
        if (std::isnan(arrival_[bin])) continue;
        samples.push_back({static_cast<double>(bin) * interval_, arrival_[bin], fitted_velocity(bin), speed_[bin]});
    }
    return samples;
}

}  // namespace talus
