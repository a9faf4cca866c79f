#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "products/debris_surface.hpp"
#include "products/particle_frames.hpp"
#include "products/triangle_mesh.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"

/// A run in three dimensions over time, for viewers: each format shows the same ground, structures and frames.
namespace talus::products {

struct View {
    const scene::Scene& scene;
    const run::RunResult& result;
    const DebrisSurface& surface;
    const std::vector<double>& times;  ///< s, of the frames

    /// A structure on the ground that is drawn.
    struct Structure {
        std::size_t index = 0;  ///< in Scene::buildings
        TriangleMesh mesh;
        report::Colour colour;
    };
    [[nodiscard]] std::vector<Structure> structures() const;
    /// Of every point of the debris: that of the map of peak speeds, up to the greatest of the run.
    [[nodiscard]] std::vector<report::Colour> speed_colours(const std::vector<float>& speeds) const;
    [[nodiscard]] double greatest_speed() const;  ///< m/s, of the whole run
};

inline constexpr report::Colour ground_colour{168, 160, 138};

/// run.glb: ground, structures and a surface of the debris per frame, of which an animation shows one at a time.
[[nodiscard]] Status write_glb(const View& view, const std::filesystem::path& file);

/// tileset.json of 3D Tiles 1.1 (OGC 22-025r4) with one tile, `glb` beside it, placed on the ellipsoid.
[[nodiscard]] Status write_tileset(const View& view, const std::filesystem::path& file, const std::string& glb);

/// run.usda (OpenUSD): ground, a mesh per structure, and the debris as points over time. `particles`: null where the
/// model has none; then points on the surface of the debris.
[[nodiscard]] Status write_usda(const View& view, const ParticleFrames* particles, const std::filesystem::path& file);

/// terrain.vtp, structures.vtp, the surface of the debris per frame with surface.pvd, and run.py, which opens all of
/// them in ParaView with the particles there are. `final_folder`: where the files will be in the end.
[[nodiscard]] Status write_paraview_view(const View& view, const std::filesystem::path& folder,
                                         const std::filesystem::path& final_folder);

}  // namespace talus::products
