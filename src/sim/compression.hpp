#pragma once

/// How far debris may be denser than at rest: compression is max(0, density / rest density - 1).
namespace talus::sim {

/// A particle above this is squeezed.
inline constexpr double squeezed_compression = 0.03;

/// Above either of these a step is too compressed: the mean over all particles, and the share of them that is squeezed.
/// A share and not the worst particle, which gets worse as the number of particles grows.
inline constexpr double mean_compression_limit = 0.01, squeezed_share_limit = 0.01;

template <class State>
[[nodiscard]] bool too_compressed(const State& state) {
    return state.mean_compression > mean_compression_limit || state.squeezed_share > squeezed_share_limit;
}

/// Whether a step needs a further iteration: compression exceeds half of a limit.
template <class State>
[[nodiscard]] bool needs_iteration(const State& state) {
    return state.mean_compression > mean_compression_limit / 2 || state.squeezed_share > squeezed_share_limit / 2;
}

}  // namespace talus::sim
