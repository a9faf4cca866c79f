#pragma once

#include <cstddef>
#include <vector>

#include "twin/frame.hpp"

namespace talus::twin {

/// Frames at even intervals of simulated time, uncompressed: compressing frames that may never be requested costs more
/// than keeping them. When memory is full, every second frame of the older half is removed.
class Recording {
  public:
    /// `interval` in s of simulated time, `room` in bytes.
    Recording(double interval, std::size_t room) : interval_(interval), room_(room) {}

    [[nodiscard]] bool due(double time) const { return time >= next_ - 1e-9; }
    /// In the order of time.
    void add(FramePtr frame);

    /// The frame at or before a time; nullptr: none.
    [[nodiscard]] FramePtr at(double time) const;
    /// Those until a time.
    [[nodiscard]] std::vector<FramePtr> until(double time) const;
    [[nodiscard]] const std::vector<FramePtr>& frames() const { return frames_; }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }

  private:
    void thin_out();
    [[nodiscard]] std::vector<FramePtr>::const_iterator after(double time) const;

    double interval_, next_ = 0;  // s
    std::size_t room_, bytes_ = 0;
    std::vector<FramePtr> frames_;
};

}  // namespace talus::twin
