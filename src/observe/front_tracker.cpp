#include "observe/front_tracker.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <utility>

#include "simd/parallel.hpp"

namespace talus::observe {
namespace {

constexpr std::size_t group = 64;  ///< particles examined together; usually none is relevant

}  // namespace

std::uint32_t front_particle_count(const sim::State& state) {
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
    candidates_.resize(state.count);
    const auto bins = static_cast<std::size_t>(flow_path_.length() / record_.interval) + 1;
    record_.arrival.assign(bins, never);
    record_.head.assign(bins, {});
    held_ = find_front(ground, state);
    farthest_ = current_;
}

void FrontTracker::follow(const sim::State& state) {
    front_count_ = front_particle_count(state);
    if (flow_path_.empty()) return;
    candidates_.resize(std::max<std::size_t>(candidates_.size(), state.count));
    held_ = static_cast<std::uint32_t>(std::count_if(state.held.begin(), state.held.begin() + state.count,
                                                     [](std::uint8_t held) { return held != 0; }));
}

std::uint32_t FrontTracker::find_candidates(const sim::Ground& ground, const sim::State& state, double from) {
    // Debris behind the front is excluded without locating it: it is outside the rectangle around the path beyond, or
    // in a cell of the path's table that does not reach so far.
    const WorldPoint& origin = ground.terrain.frame().origin;
    const Extent beyond = flow_path_.extent_beyond(from).grown(0.01);  // for the rounding to float
    const auto x_min = static_cast<float>(beyond.x_min - origin.x), x_max = static_cast<float>(beyond.x_max - origin.x);
    const auto y_min = static_cast<float>(beyond.y_min - origin.y), y_max = static_cast<float>(beyond.y_max - origin.y);
    const auto chainage_of = [&](std::size_t i) -> float {
        const PlanPoint p{origin.x + state.position.x[i], origin.y + state.position.y[i]};
        const float bound = flow_path_.chainage_bound(p);
        if (bound < 0 || bound < from) return -1;
        const auto at = flow_path_.locate(p);
        return at ? static_cast<float>(at->chainage) : -1;
    };
    const auto examine = [&](std::size_t first, std::size_t last) {
        std::array<Candidate, group> found{};
        std::uint32_t count = 0;
        for (std::size_t i = first; i < last; ++i) {
            if (state.held[i] != 0) continue;
            const float chainage = chainage_of(i);
            if (chainage >= 0 && chainage >= from) found[count++] = {static_cast<std::uint32_t>(i), chainage};
        }
        if (count == 0) return;
        const std::uint32_t place = std::atomic_ref(candidate_count_).fetch_add(count, std::memory_order_relaxed);
        std::copy_n(found.begin(), count, candidates_.begin() + place);
    };
    candidate_count_ = 0;
    return simd::reduce_ranges(
        state.count, 4096, std::uint32_t{0},
        [&](std::size_t first, std::size_t last, std::uint32_t held) {
            for (std::size_t begin = first; begin < last; begin += group) {
                const std::size_t end = std::min(last, begin + group);
                unsigned inside = 0, held_here = 0;
                for (std::size_t i = begin; i < end; ++i) {
                    const float x = state.position.x[i], y = state.position.y[i];
                    inside |= static_cast<unsigned>(x >= x_min) & static_cast<unsigned>(x <= x_max) &
                              static_cast<unsigned>(y >= y_min) & static_cast<unsigned>(y <= y_max);
                    held_here += static_cast<unsigned>(state.held[i] != 0);
                }
                held += held_here;
                if (inside != 0) examine(begin, end);
            }
            return held;
        },
        std::plus<>{});
}

std::uint32_t FrontTracker::find_front(const sim::Ground& ground, const sim::State& state) {
    std::uint32_t held = 0;
    const auto find_enough = [&](double from) {
        held = find_candidates(ground, state, from);
        return candidate_count_ >= front_count_;
    };
    // The front hardly moves within a step: debris well behind its last position need not be located.
    const double nearly = std::isnan(current_) ? 0 : std::max(0.0, current_ - head_length_);
    if (find_enough(nearly) || (nearly > 0 && find_enough(0))) {
        const auto front = candidates_.begin() + static_cast<std::ptrdiff_t>(front_count_) - 1;
        std::nth_element(candidates_.begin(), front, candidates_.begin() + candidate_count_,
                         [](const Candidate& a, const Candidate& b) { return a.chainage > b.chainage; });
        current_ = front->chainage;
    } else {
        current_ = never;
    }
    return held;
}

FrontRecord::Head FrontTracker::head_behind(double front, const sim::State& state) {
    const auto from = static_cast<float>(std::max(0.0, front - head_length_));
    // Always in the same order: the sum would depend on it.
    const auto end = candidates_.begin() + candidate_count_;
    std::sort(candidates_.begin(), end, [](const Candidate& a, const Candidate& b) { return a.particle < b.particle; });
    double sum = 0, fastest = 0;
    std::size_t count = 0;
    for (auto candidate = candidates_.begin(); candidate != end; ++candidate) {
        if (candidate->chainage < from) continue;
        const double speed = length(state.velocity.at(candidate->particle));
        sum += speed;
        fastest = std::max(fastest, speed);
        ++count;
    }
    return {sum / static_cast<double>(count), fastest};
}

void FrontTracker::after_step(const sim::Ground& ground, const sim::State& state) {
    if (flow_path_.empty()) return;
    front_count_ = front_particle_count(state);
    if (candidates_.size() < state.count) candidates_.resize(state.count + state.count / 2);
    const double before = current_;
    const std::uint32_t held = find_front(ground, state);
    const bool release_started = held != held_;
    held_ = held;
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
        if (std::isnan(head.mean)) head = head_behind(current_, state);
        record_.head[bin] = head;
    }
    farthest_ = current_;
}

bool FrontRecord::jumped_to(std::size_t bin) const {
    const double fastest = std::max(head[bin].fastest, head[bin - 1].fastest);
    return interval > fastest_front * fastest * (arrival[bin] - arrival[bin - 1]);  // false without both arrivals
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
