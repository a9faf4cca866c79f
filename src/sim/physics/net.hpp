#pragma once

#include <cstdint>

namespace talus::sim {

/// The rank of a particle by grain size: 0 for the finest, just below 1 for the coarsest. A net with passing share p
/// lets particles of rank below p through and is a wall for the others: debris that passes one net passes every wider
/// one. The rank is a hash of the particle's id (the finalizer of MurmurHash3, Appleby 2011), so that neighbours
/// differ, the shares hold on average wherever debris comes from, and nothing has to be stored.
TALUS_DEVICE inline float grain_rank(std::uint32_t id) {
    std::uint32_t hash = id + 0x9e3779b9U;  // 0 would stay 0
    hash = (hash ^ (hash >> 16U)) * 0x85ebca6bU;
    hash = (hash ^ (hash >> 13U)) * 0xc2b2ae35U;
    hash ^= hash >> 16U;
    return static_cast<float>(hash >> 8U) * 0x1p-24F;
}

}  // namespace talus::sim
