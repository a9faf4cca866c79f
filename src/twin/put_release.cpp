#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/outline.hpp"
#include "twin/put.hpp"

namespace talus::twin {

using nlohmann::json;

Result<Release> read_release(const json& action, const ActionContext& context, const Setup& setup,
                             const ReleaseSetup* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, {"action", "id", "name", "polygon", "move_m", "thickness_m"}));
    TALUS_ASSIGN(auto polygon, read_points(action, "polygon", true, 3, most_points));
    TALUS_ASSIGN(const auto thickness,
                 read_number(action, "thickness_m", find_section("release")->find("thickness_m")->range, "m"));
    TALUS_ASSIGN(const auto by, read_move(action, "polygon", "release", existing != nullptr));
    if (existing == nullptr && !polygon) return missing("polygon", "release");
    if (existing == nullptr && !thickness) return missing("thickness_m", "release");

    Release release;
    release.start_time = std::numeric_limits<double>::infinity();
    if (existing != nullptr) release = *existing->body;
    release.name = name;
    if (polygon) {
        TALUS_TRY(check_ring(context.scene.terrain, *polygon, "polygon", true));
        const double before = release.patches.empty() ? 0 : release.patches.front().thickness;
        if (release.thickness_raster && !thickness) {
            return Error{
                "thickness_m: missing; the release has a raster of thicknesses, a new outline needs one value"};
        }
        release.patches = {{{std::move(*polygon), {}}, before}};
        release.thickness_raster.reset();
    }
    if (by) {
        if (release.thickness_raster && !thickness) {
            return Error{"move_m: the release has a raster of thicknesses, which stays where it is; give thickness_m"};
        }
        for (ReleasePatch& patch : release.patches) {
            patch.polygon = moved(std::move(patch.polygon), *by);
            TALUS_TRY(check_ground(context.scene.terrain, patch.polygon, "move_m", true));
        }
    }
    if (thickness) {
        release.thickness_raster.reset();
        for (ReleasePatch& patch : release.patches) patch.thickness = *thickness;
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
