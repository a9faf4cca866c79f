#pragma once

#include <atomic>
#include <cstdint>

#include "core/number.hpp"

/// What several particles of a kernel may write at once. Sums are of whole numbers, so that their order does not
/// matter.
namespace talus::sim::device {

template <class Whole>
TALUS_DEVICE void add_atomically(Whole& sum, Whole value) {
#if defined(__CUDA_ARCH__)
    atomicAdd(&sum, value);
#else
    std::atomic_ref(sum).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Several may store the same value.
TALUS_DEVICE inline void store_shared(std::uint8_t& to, std::uint8_t value) {
#if defined(__CUDA_ARCH__)
    *static_cast<volatile std::uint8_t*>(&to) = value;
#else
    std::atomic_ref(to).store(value, std::memory_order_relaxed);
#endif
}

}  // namespace talus::sim::device
