#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "params/spec.hpp"

/// What moves the particles: the processor (sim/cpu) or a device (sim/device).
namespace talus::sim {

inline constexpr std::array backend_choices = {params::BackendChoice::cpu, params::BackendChoice::cuda,
                                               params::BackendChoice::automatic, params::BackendChoice::host};

/// Success if this machine has the backend; why not, in one line, otherwise.
[[nodiscard]] Status check_backend(params::BackendChoice choice);

/// What `automatic` is for a number of particles: the graphics card if there is one and they keep it busy, else the
/// processor. Others stay as they are.
[[nodiscard]] params::BackendChoice settled_backend(params::BackendChoice choice, std::uint32_t particles);

/// As a scene names it: "cpu", "cuda", ...
[[nodiscard]] std::string_view backend_name(params::BackendChoice choice);

/// The backends of this machine, with what stands behind each, for `talus --version`.
[[nodiscard]] std::string describe_backends();

}  // namespace talus::sim
