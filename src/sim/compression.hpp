#pragma once

#include "core/number.hpp"

/// How far debris may be denser than at rest: compression is max(0, density / rest density - 1).
namespace talus::sim {

/// A particle above this is overcompressed.
inline constexpr double overcompressed_compression = 0.03;

/// Above either of these a step is too compressed: the mean over all particles, and the share of them that is
/// overcompressed. A share and not the worst particle, which gets worse as the number of particles grows.
inline constexpr double mean_compression_limit = 0.01, overcompressed_share_limit = 0.01;

/// Iterations undo the compression that the step adds to what it started with, which is spread afterwards (see
/// DensityConstraint). What a step adds is negligible below this share of a limit.
inline constexpr double negligible_share = 0.1;

template <class State>
[[nodiscard]] bool too_compressed(const State& state) {
    return state.mean_compression > mean_compression_limit || state.overcompressed_share > overcompressed_share_limit;
}

/// Whether a step needs a further iteration: compression exceeds half of a limit, and the step itself adds to it.
template <class State>
[[nodiscard]] bool needs_iteration(const State& state) {
    constexpr double mean_limit = mean_compression_limit / 2, share_limit = overcompressed_share_limit / 2;
    return (state.mean_compression > mean_limit && state.mean_added_compression > negligible_share * mean_limit) ||
           state.squeezing_share > share_limit;
}

/// What a step measures of the compression of its particles.
struct CompressionSum {
    double sum = 0, added = 0;
    float max = 0;
    double overcompressed = 0;  ///< particles
    double squeezing = 0;       ///< of these, the ones whose compression the step still adds to

    /// `before`: of the particle when the step started.
    TALUS_DEVICE void add(float compression, float before) {
        const float gain = compression > before ? compression - before : 0;
        sum += compression;
        added += gain;
        max = compression > max ? compression : max;
        if (compression <= static_cast<float>(overcompressed_compression)) return;
        overcompressed += 1;
        squeezing += gain > static_cast<float>(negligible_share * overcompressed_compression) ? 1 : 0;
    }
    friend TALUS_DEVICE CompressionSum operator+(const CompressionSum& a, const CompressionSum& b) {
        return {a.sum + b.sum, a.added + b.added, a.max > b.max ? a.max : b.max, a.overcompressed + b.overcompressed,
                a.squeezing + b.squeezing};
    }
    /// `count`: of all particles, not of those added here alone.
    template <class State>
    void write(State& state, double count) const {
        if (count <= 0) count = 1;
        state.mean_compression = sum / count;
        state.mean_added_compression = added / count;
        state.max_compression = max;
        state.overcompressed_share = overcompressed / count;
        state.squeezing_share = squeezing / count;
    }
};

}  // namespace talus::sim
