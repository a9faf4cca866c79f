#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {

Result<terrain::Release> read_release(const nlohmann::json& action, const ActionContext& context, const Setup& setup,
                                      const ReleaseSetup* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, live_keys("release"), {"action", "id", "name", "polygon", "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(action, "polygon", "release", existing != nullptr));
    if (existing == nullptr && !drawn.ring) return missing("polygon", "release");
    if (existing == nullptr) TALUS_TRY(check_complete(action, "release", "release"));

    terrain::Release release;
    release.spec.start_time = std::numeric_limits<double>::infinity();
    if (existing != nullptr) release = *existing->body;
    release.name = name;
    TALUS_TRY(read_values(action, release.spec));
    TALUS_TRY(check_rules(release.spec, context.scene.spec.solver, context.particle_spacing));
    const bool uniform = gives(action, "thickness_m");
    if (release.thickness_raster && drawn && !uniform) {
        return Error{
            drawn.ring ? "thickness_m: missing; the release has a raster of thicknesses, a new outline needs one value"
                       : "move_m: the release has a raster of thicknesses, which stays where it is; give thickness_m"};
    }
    TALUS_TRY(redraw(drawn, context.scene.terrain, true, release.patches));
    if (uniform) {
        release.thickness_raster.reset();
        for (terrain::ReleasePatch& patch : release.patches) patch.thickness = *release.spec.thickness;
    }
    TALUS_TRY(check_overlaps(release, setup, existing != nullptr ? existing->id : ""));
    release.volume = release_volume(context.scene.terrain, release);
    const double smallest = std::pow(context.particle_spacing, 3);
    if (release.volume < smallest) {
        return Error{fmt::format("polygon: holds {:.3g} m3; it must be at least one particle, {:.3g} m3",
                                 release.volume, smallest)};
    }
    return release;
}

}  // namespace talus::twin
