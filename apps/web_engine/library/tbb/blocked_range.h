#pragma once

#include <cstddef>

/// What the program uses of oneTBB, on one thread: a page has more only where its server sends headers that static
/// hosts do not. The parts are those of oneTBB, so that sums have the same bits.
namespace tbb {

template <class Value>
class blocked_range {
  public:
    blocked_range(Value begin, Value end, std::size_t grain = 1) : begin_(begin), end_(end), grain_(grain) {}
    [[nodiscard]] Value begin() const { return begin_; }
    [[nodiscard]] Value end() const { return end_; }
    [[nodiscard]] bool empty() const { return !(begin_ < end_); }
    [[nodiscard]] bool is_divisible() const { return grain_ < static_cast<std::size_t>(end_ - begin_); }
    [[nodiscard]] std::size_t grainsize() const { return grain_; }
    [[nodiscard]] Value middle() const { return begin_ + (end_ - begin_) / 2; }

  private:
    Value begin_, end_;
    std::size_t grain_;
};

}  // namespace tbb
