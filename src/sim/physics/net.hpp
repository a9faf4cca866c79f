#pragma once

#include <cstdint>

namespace talus {

/// Where a particle stands among all of the debris by the size of its grains: 0 the finest, to below 1 the coarsest. A
/// net whose meshes let the share p of the debris through is no wall for the particles of rank below p, and a wall for
/// the others: what goes through one net goes through every wider one. The rank is a hash of the particle's id
/// (the finalizer of MurmurHash3, Appleby 2011), so that neighbours differ, shares hold on average wherever debris
/// comes from, and nothing has to be kept.
inline float grain_rank(std::uint32_t id) {
    std::uint32_t hash = id + 0x9e3779b9U;  // 0 would stay 0
    hash = (hash ^ (hash >> 16U)) * 0x85ebca6bU;
    hash = (hash ^ (hash >> 13U)) * 0xc2b2ae35U;
    hash ^= hash >> 16U;
    return static_cast<float>(hash >> 8U) * 0x1p-24F;
}

}  // namespace talus
