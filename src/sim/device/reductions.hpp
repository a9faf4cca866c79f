#pragma once

#include <cstdint>

#include "sim/compression.hpp"
#include "sim/device/views.hpp"
#include "sim/motion.hpp"

/// What is joined over all particles, and how.
namespace talus::sim::device {

struct CompressionOf {
    const float *compression{}, *before{};

    TALUS_DEVICE CompressionSum operator()(std::uint32_t i) const {
        CompressionSum own;
        own.add(compression[i], before[i]);
        return own;
    }
};
struct MotionOf {
    Data d;
    MotionCount count{};

    TALUS_DEVICE Motion operator()(std::uint32_t i) const { return count(d.state.velocity[i]); }
};
struct PlaceOf {
    Data d;
    std::uint32_t first{}, last{};  ///< ids

    TALUS_DEVICE PlaceSum operator()(std::uint32_t i) const {
        const std::uint32_t id = d.state.id[i];
        return id >= first && id < last ? PlaceSum::of(d.state.position[i]) : PlaceSum{};
    }
};
struct IsAwake {
    const std::uint8_t* asleep;

    TALUS_DEVICE std::uint32_t operator()(std::uint32_t i) const { return asleep[i] == 0 ? 1 : 0; }
};
struct CountOf {
    const std::uint32_t* counts;

    TALUS_DEVICE std::uint64_t operator()(std::uint32_t i) const { return counts[i]; }
};
struct Add {
    template <class Number>
    TALUS_DEVICE Number operator()(const Number& a, const Number& b) const {
        return a + b;
    }
};
/// The greater of two; NaN takes precedence, or it would be missed.
struct GreaterOrUnknown {
    TALUS_DEVICE float operator()(float a, float b) const { return a != a || b <= a ? a : b; }
};

}  // namespace talus::sim::device
