#include "twin/recording.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace talus::twin {

void Recording::add(FramePtr frame) {
    next_ = (std::floor(frame->time / interval_ + 1e-6) + 1) * interval_;
    bytes_ += frame->bytes();
    frames_.push_back(std::move(frame));
    while (bytes_ > room_ && frames_.size() > 2) thin_out();
}

void Recording::thin_out() {
    // The first frame is kept: it is the initial state.
    const std::size_t half = std::max<std::size_t>(2, frames_.size() / 2);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
        if (k < half && k % 2 == 1) {
            bytes_ -= frames_[k]->bytes();
            continue;
        }
        if (kept != k) frames_[kept] = std::move(frames_[k]);
        ++kept;
    }
    frames_.resize(kept);
}

std::vector<FramePtr>::const_iterator Recording::after(double time) const {
    return std::upper_bound(frames_.begin(), frames_.end(), time + 1e-9,
                            [](double t, const FramePtr& frame) { return t < frame->time; });
}

FramePtr Recording::at(double time) const {
    const auto end = after(time);
    return end == frames_.begin() ? nullptr : *(end - 1);
}

std::vector<FramePtr> Recording::until(double time) const {
    return {frames_.begin(), after(time)};
}

}  // namespace talus::twin
