#include "observe/front_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus::observe {
std::uint32_t front_particle_count(const sim::StateSummary& state) {
    const std::uint32_t released = state.released() + state.entrained;
    const auto share = static_cast<std::uint32_t>(std::ceil(0.001 * released));
    return std::max(1U, std::min(released, std::max(5U, share)));
}

double fitted_velocity(std::span<const double> arrival, std::size_t first, std::size_t last, double interval) {
    double count = 0, mean_time = 0, mean_chainage = 0;
    for (std::size_t row = first; row <= last; ++row) {
        if (std::isnan(arrival[row])) continue;
        count += 1;
        mean_time += arrival[row];
        mean_chainage += static_cast<double>(row) * interval;
    }
    mean_time /= count;
    mean_chainage /= count;
    double covariance = 0, variance = 0;
    for (std::size_t row = first; row <= last; ++row) {
        if (std::isnan(arrival[row])) continue;
        const double t = arrival[row] - mean_time;
        covariance += t * (static_cast<double>(row) * interval - mean_chainage);
        variance += t * t;
    }
    return variance > 0 ? covariance / variance : never;
}

FrontTracker::FrontTracker(const sim::Model& model, const sim::Ground& ground, const sim::State& state,
                           terrain::FlowPath flow_path, double chainage_interval, double velocity_window)
    : flow_path_(std::move(flow_path)),
      head_length_(std::max(2 * model.support_radius, chainage_interval)),
      front_count_(front_particle_count(state)) {
    record_.interval = chainage_interval;
    record_.window = velocity_window;
    if (flow_path_.empty()) return;
    candidates_.found.resize(state.count);
    const auto bins = static_cast<std::size_t>(flow_path_.length() / record_.interval) + 1;
    record_.arrival.assign(bins, never);
    record_.head.assign(bins, {});
    find_front(ground, state);
    held_ = candidates_.held;
    farthest_ = current_;
}

void FrontTracker::follow(const sim::State& state) {
    front_count_ = front_particle_count(state);
    if (flow_path_.empty()) return;
    candidates_.found.resize(std::max<std::size_t>(candidates_.found.size(), state.count));
    held_ = static_cast<std::uint32_t>(std::count_if(state.held.begin(), state.held.begin() + state.count,
                                                     [](std::uint8_t held) { return held != 0; }));
}

void FrontTracker::find_front(const sim::Ground& ground, const Debris& debris) {
    const WorldPoint& origin = ground.terrain.frame().origin;
    const auto find_enough = [&](double from) {
        debris.find_on_path(flow_path_, {origin.x, origin.y}, from, candidates_);
        return candidates_.count >= front_count_;
    };
    // The front hardly moves within a step: debris well behind its last position need not be located.
    const double nearly = std::isnan(current_) ? 0 : std::max(0.0, current_ - head_length_);
    if (find_enough(nearly) || (nearly > 0 && find_enough(0))) {
        const auto first = candidates_.found.begin();
        const auto front = first + static_cast<std::ptrdiff_t>(front_count_) - 1;
        std::nth_element(first, front, first + candidates_.count,
                         [](const PathParticle& a, const PathParticle& b) { return a.chainage > b.chainage; });
        current_ = front->chainage;
    } else {
        current_ = never;
    }
}

FrontRecord::Head FrontTracker::head_behind(double front) {
    const auto from = static_cast<float>(std::max(0.0, front - head_length_));
    // Always in the same order: the sum would depend on it.
    const auto first = candidates_.found.begin(), end = first + candidates_.count;
    std::sort(first, end, [](const PathParticle& a, const PathParticle& b) { return a.particle < b.particle; });
    double sum = 0, fastest = 0;
    std::size_t count = 0;
    for (auto candidate = first; candidate != end; ++candidate) {
        if (candidate->chainage < from) continue;
        const double speed = candidate->speed;
        sum += speed;
        fastest = std::max(fastest, speed);
        ++count;
    }
    return {sum / static_cast<double>(count), fastest};
}

void FrontTracker::after_step(const sim::Ground& ground, const Debris& debris) {
    if (flow_path_.empty()) return;
    const sim::StateSummary& state = debris.summary();
    front_count_ = front_particle_count(state);
    const double before = current_;
    find_front(ground, debris);
    const bool release_started = candidates_.held != held_;
    held_ = candidates_.held;
    if (std::isnan(current_) || current_ <= farthest_) return;
    if (std::isnan(farthest_) || release_started) {
        farthest_ = current_;
        return;
    }
    const double from = std::isnan(before) ? farthest_ : before;
    FrontRecord::Head head;
    const double interval = record_.interval;
    for (auto bin = static_cast<std::size_t>(farthest_ / interval) + 1;
         bin < record_.arrival.size() && static_cast<double>(bin) * interval <= current_; ++bin) {
        const double share = (static_cast<double>(bin) * interval - from) / (current_ - from);
        record_.arrival[bin] = state.time - state.time_step * (1 - share);
        if (std::isnan(head.mean)) head = head_behind(current_);
        record_.head[bin] = head;
    }
    farthest_ = current_;
}

double FrontRecord::fastest(std::size_t first, std::size_t last) const {
    double fastest = 0;
    for (std::size_t row = first; row <= last; ++row) fastest = std::fmax(fastest, head[row].fastest);
    return fastest;
}

bool FrontRecord::jumped_to(std::size_t bin) const {
    const auto arrived = [&](std::size_t row) { return row < arrival.size() && !std::isnan(arrival[row]); };
    if (!arrived(bin - 1) || !arrived(bin)) return false;
    std::size_t first = bin - 1, last = bin;
    const auto too_short = [&] { return static_cast<double>(last - first) * interval < resolution; };
    for (bool longer = true; longer && too_short();) {
        longer = false;
        if (first > 0 && arrived(first - 1)) {
            --first;
            longer = true;
        }
        if (too_short() && arrived(last + 1)) {
            ++last;
            longer = true;
        }
    }
    return static_cast<double>(last - first) * interval >
           fastest_front * fastest(first, last) * (arrival[last] - arrival[first]);
}

double FrontRecord::velocity_at(std::size_t middle) const {
    const auto half = static_cast<std::size_t>(std::max(1.0, std::floor(window / 2 / interval)));
    // Not across a jump.
    std::size_t first = middle, last = middle;
    while (first > 0 && middle - first < half && !jumped_to(first)) --first;
    while (last + 1 < arrival.size() && last - middle < half && !jumped_to(last + 1)) ++last;
    return fitted_velocity(arrival, first, last, interval);
}

std::vector<FrontSample> FrontRecord::samples() const {
    std::vector<FrontSample> samples;
    for (std::size_t bin = 0; bin < arrival.size(); ++bin) {
        if (std::isnan(arrival[bin])) continue;
        samples.push_back({static_cast<double>(bin) * interval, arrival[bin], velocity_at(bin), head[bin].mean});
    }
    return samples;
}

}  // namespace talus::observe
