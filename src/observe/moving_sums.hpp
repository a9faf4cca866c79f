#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace talus::observe {

/// Sums over numbered slots within a time window that ends now. An amount may arrive over a time that is longer than a
/// step. Cost depends on what is added, not on the number of slots. A step that straddles the window's start, or is
/// longer than it, counts with the part inside.
class MovingSums {
  public:
    /// `window` in s.
    explicit MovingSums(double window) : window_(window) {}

    [[nodiscard]] double window() const { return window_; }
    [[nodiscard]] std::size_t size() const { return slots_.size(); }
    void resize(std::size_t slots) { slots_.resize(slots); }

    /// Adds to the step that the next advance() ends.
    void add(std::size_t slot, double amount);
    /// Adds an amount that arrives evenly within `duration`, s, from the beginning of that step; at least the step.
    void add(std::size_t slot, double amount, double duration);
    /// Ends a step at `time`.
    void advance(double time, double time_step);
    /// Slots that the last step added to.
    [[nodiscard]] const std::vector<std::uint32_t>& added() const { return added_; }
    /// Mean rate over the window: the sum of a slot divided by the window.
    [[nodiscard]] double rate(std::size_t slot) const { return slots_[slot].sum / window_; }
    /// Sets `count` slots starting at `first` to zero.
    void clear(std::size_t first, std::size_t count);

    template <class Archive>
    void keep(Archive& archive) {
        archive(slots_, arrivals_, entries_, first_, adding_, added_);
    }

  private:
    struct Slot {
        double sum = 0, step = 0;   // within the window; of the current step
        std::uint32_t entries = 0;  // of the slot; 0: the sum is exactly zero
        bool added = false;         // in the current step
    };
    /// What has yet to arrive.
    struct Arrival {
        double amount = 0, duration = 0;  // s
        std::uint32_t slot = 0;
    };
    void take_arrivals(double time_step);
    /// What a step added to a slot.
    struct Entry {
        double begin = 0, end = 0, amount = 0;  // s, s
        std::uint32_t slot = 0;
    };
    void take_out(Entry& entry, double begin);

    double window_;
    std::vector<Slot> slots_;
    std::vector<Arrival> arrivals_;
    std::vector<Entry> entries_;  // in the order of time, from first_ on
    std::size_t first_ = 0;
    std::vector<std::uint32_t> adding_, added_;
};

}  // namespace talus::observe
