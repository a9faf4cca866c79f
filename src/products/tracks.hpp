#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "run/run_scene.hpp"
#include "scene/scene.hpp"

namespace talus::products {

/// The ways of some particles, evenly chosen among all of them: takes the frames of a run and writes tracks.csv, a row
/// per particle and frame, and tracks.gpkg, a line per particle with elevation and time at each of its points.
class Tracks {
  public:
    /// outputs.tracks of them.
    explicit Tracks(const scene::Scene& scene);

    /// Whether the scene asks for any.
    [[nodiscard]] static bool wanted(const scene::Scene& scene) { return scene.spec.outputs.tracks > 0; }

    void add(const run::Frame& frame);
    /// The files are written into an existing folder.
    [[nodiscard]] Status write(const std::filesystem::path& folder) const;

  private:
    struct Place {
        double time = 0;  ///< s
        WorldPoint at;
        double speed = 0;  ///< m/s
    };
    const scene::Scene& scene_;
    std::uint32_t stride_ = 1;  ///< particles whose ids are a multiple of it are followed
    std::map<std::uint32_t, std::vector<Place>> places_;
};

}  // namespace talus::products
