#include "run/time_left.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

namespace talus::run {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double told_left(double elapsed, double left) {
    return elapsed >= least_share_done * (elapsed + left) ? left : unknown;
}

WorkClock::WorkClock(const std::vector<double>& efforts, int at_once)
    : at_once_(std::max(1, at_once)), start_(unknown) {
    pieces_.reserve(efforts.size());
    for (const double effort : efforts) pieces_.push_back({.effort = effort});
}

WorkClock::Piece& WorkClock::piece(std::size_t run) {
    if (run >= pieces_.size()) pieces_.resize(run + 1);
    return pieces_[run];
}

void WorkClock::found(std::size_t run, double wall_time) {
    Piece& piece = this->piece(run);
    piece.phase = Phase::over;
    piece.effort = 0;  // none of this call's
    earlier_time_ += wall_time;
    earlier_effort_ += 1;
}

void WorkClock::begin(std::size_t run, double now) {
    Piece& piece = this->piece(run);
    piece.phase = Phase::under_way;
    piece.begun = now;
    piece.end = unknown;
    if (std::isnan(start_)) start_ = now;
}

void WorkClock::tick(std::size_t run, double now, double remaining) {
    piece(run).end = now + remaining;
}

void WorkClock::end(std::size_t run, double now) {
    piece(run).phase = Phase::over;
    piece(run).end = now;
}

/// s, of a run of effort 1. Those under way count as well: the first to end are the short ones.
double WorkClock::unit() const {
    double time = 0, effort = 0;
    for (const Piece& piece : pieces_) {
        if (piece.phase == Phase::waiting || piece.effort <= 0 || std::isnan(piece.end)) continue;
        time += piece.end - piece.begun;
        effort += piece.effort;
    }
    if (effort > 0) return time / effort;
    return earlier_effort_ > 0 ? earlier_time_ / earlier_effort_ : unknown;
}

double WorkClock::left(double now) const {
    const double unit = this->unit();
    // When each of those at work is free again, the next one first.
    std::priority_queue<double, std::vector<double>, std::greater<>> free;
    for (const Piece& piece : pieces_) {
        if (piece.phase != Phase::under_way) continue;
        const double by_others = piece.begun + unit * piece.effort - now;
        const double own = std::isnan(piece.end) ? (by_others > 0 ? by_others : unknown) : piece.end - now;
        if (std::isnan(own)) return unknown;
        free.push(std::max(0.0, own));
    }
    while (free.size() < static_cast<std::size_t>(at_once_)) free.push(0);
    double last = 0;
    const auto take = [&](double work) {
        const double end = free.top() + work;
        free.pop();
        free.push(end);
        last = std::max(last, end);
    };
    for (const Piece& piece : pieces_) {
        if (piece.phase != Phase::waiting) continue;
        if (std::isnan(unit)) return unknown;
        take(unit * piece.effort);
    }
    for (; !free.empty(); free.pop()) last = std::max(last, free.top());
    return last;
}

double WorkClock::elapsed(double now) const {
    return std::isnan(start_) ? 0 : now - start_;
}

double WorkClock::share_done(double now) {
    const double left = this->left(now), all = elapsed(now) + left;
    if (all > 0) share_done_ = std::max(share_done_, elapsed(now) / all);
    return share_done_;
}

}  // namespace talus::run
