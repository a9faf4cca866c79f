#pragma once

#include <span>
#include <string_view>

/// What the depth-averaged model makes of every key of a scene.
namespace talus::scene {

enum class KeyUse {
    used,     ///< it changes what is computed, measured or said
    own,      ///< the same, and means nothing to particles; given with them alone, it is named in a note
    noted,    ///< it means something to particles only; given, it is named in a note
    refused,  ///< a scene that gives it is refused
};

struct DepthAveragedKey {
    std::string_view key;  ///< "solver.kernel"; "terrain.*": all keys of a section
    KeyUse use;
    std::string_view why;  ///< of a refusal: "has no nets"
};

/// All keys of the schema, each once.
[[nodiscard]] std::span<const DepthAveragedKey> depth_averaged_keys();

/// The entry of a key without the number of its section ("release.volume_m3"); null: there is none, a mistake.
[[nodiscard]] const DepthAveragedKey* depth_averaged_key(std::string_view key);

/// Whether a key means something to particles only: the depth-averaged model has no use for it.
[[nodiscard]] bool for_particles_only(std::string_view key);
/// The other way round.
[[nodiscard]] bool for_depth_averaged_only(std::string_view key);

}  // namespace talus::scene
