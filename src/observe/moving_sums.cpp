#include "observe/moving_sums.hpp"

namespace talus::observe {

void MovingSums::add(std::size_t slot, double amount) {
    Slot& s = slots_[slot];
    if (!s.added) {
        s.added = true;
        s.step = 0;
        adding_.push_back(static_cast<std::uint32_t>(slot));
    }
    s.step += amount;
}

void MovingSums::add(std::size_t slot, double amount, double duration) {
    arrivals_.push_back({amount, duration, static_cast<std::uint32_t>(slot)});
}

void MovingSums::take_arrivals(double time_step) {
    std::size_t left = 0;
    for (Arrival& arrival : arrivals_) {
        const bool last = arrival.duration <= time_step;
        const double amount = last ? arrival.amount : arrival.amount * (time_step / arrival.duration);
        add(arrival.slot, amount);
        arrival.amount -= amount;
        arrival.duration -= time_step;
        if (!last) arrivals_[left++] = arrival;
    }
    arrivals_.resize(left);
}

/// The part of an entry that lies before `begin`.
void MovingSums::take_out(Entry& entry, double begin) {
    Slot& slot = slots_[entry.slot];
    if (entry.end <= begin) {
        slot.sum = --slot.entries == 0 ? 0 : slot.sum - entry.amount;
        return;
    }
    const double part = entry.amount * (begin - entry.begin) / (entry.end - entry.begin);
    slot.sum -= part;
    entry.amount -= part;
    entry.begin = begin;
}

void MovingSums::advance(double time, double time_step) {
    take_arrivals(time_step);
    for (const std::uint32_t slot : adding_) {
        Slot& s = slots_[slot];
        s.added = false;
        s.sum += s.step;
        ++s.entries;
        entries_.push_back({time - time_step, time, s.step, slot});
    }
    added_.swap(adding_);
    adding_.clear();

    const double begin = time - window_;
    for (std::size_t k = first_; k < entries_.size() && entries_[k].begin < begin; ++k) {
        take_out(entries_[k], begin);
        if (entries_[k].end <= begin) first_ = k + 1;
    }
    // Expired entries are erased when they are half of all: an entry is moved once on average.
    if (2 * first_ > entries_.size()) {
        entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(first_));
        first_ = 0;
    }
}

void MovingSums::clear(std::size_t first, std::size_t count) {
    for (std::size_t slot = first; slot < first + count; ++slot) {
        slots_[slot].sum = slots_[slot].step = 0;
    }
    const auto cleared = [&](std::size_t slot) { return slot >= first && slot < first + count; };
    for (std::size_t k = first_; k < entries_.size(); ++k) {
        if (cleared(entries_[k].slot)) entries_[k].amount = 0;
    }
    std::erase_if(arrivals_, [&](const Arrival& arrival) { return cleared(arrival.slot); });
}

}  // namespace talus::observe
