#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/live_run.hpp"
#include "twin/outline.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

/// NaN where it differs from place to place.
double thickness_of(const terrain::Release& release) {
    if (release.patches.empty() || release.thickness_raster) return observe::never;
    const double thickness = release.patches.front().thickness;
    const bool same = std::all_of(release.patches.begin(), release.patches.end(),
                                  [&](const terrain::ReleasePatch& patch) { return patch.thickness == thickness; });
    return same ? thickness : observe::never;
}

/// Checks that it covers no ground of the setup's other releases.
Status check_overlaps(const terrain::Release& release, const Setup& setup, const ReleaseSetup* existing) {
    for (const ReleaseSetup& other : setup.releases) {
        if (existing != nullptr && other.id == existing->id) continue;
        for (const terrain::ReleasePatch& theirs : other.body->patches) {
            for (const terrain::ReleasePatch& ours : release.patches) {
                const std::string shared = scene::shared_ground(ours.polygon, theirs.polygon);
                if (shared.empty()) continue;
                return Error{fmt::format("polygon: overlaps release \"{}\" {}", other.body->name, shared)};
            }
        }
    }
    return {};
}

}  // namespace

terrain::Release Releases::fresh() {
    terrain::Release release;
    release.spec.start_time = std::numeric_limits<double>::infinity();
    return release;
}

json Releases::body(const Body& release) {
    json body = values_json(release.spec);
    body["name"] = release.name;
    write_parts(release.patches, "thicknesses_m", &terrain::ReleasePatch::thickness, body);
    if (release.thickness_raster) body["raster"] = true;
    return body;
}

json Releases::more(const Entry& release, Shown& shown) {
    const bool begun = release.triggered || shown.run.has_begun(release.id);
    return {{"thickness_m", number_or_null<json>(thickness_of(*release.body))},
            {"volume_m3", release.body->volume},
            {"status", begun ? "released" : "held"},
            {"start_time_s", number_or_null<json>(shown.run.start_time_of(release.id))}};
}

Status Releases::read(const json& file, const scene::Scene& scene, Body& release) {
    TALUS_TRY(check_keys(file, live_keys("release"), {"name", "polygons", "thicknesses_m", "raster", "triggered"}));
    TALUS_ASSIGN(release.name, read_name(file));
    TALUS_TRY(read_values(file, release.spec));
    if (!file.contains("raster")) release.thickness_raster.reset();
    TALUS_TRY(read_parts(file, "thicknesses_m", &terrain::ReleasePatch::thickness, release.patches));
    release.volume = release_volume(scene.terrain, release);
    return {};
}

Status Releases::put(const Put<Entry>& put, Body& release) {
    const json& given = put.given;
    const terrain::Terrain& terrain = put.context.scene.terrain;
    TALUS_TRY(check_keys(given, live_keys("release"), {"name", "polygon", "move_m"}));
    TALUS_ASSIGN(const Redrawn drawn, read_outline(given, "polygon", name, put.existing != nullptr));
    if (put.existing == nullptr) TALUS_TRY(check_complete(given, "release", name));
    release.name = put.name;
    TALUS_TRY(read_values(given, release.spec));
    TALUS_TRY(check_rules(release.spec, put.context.scene.spec.solver, put.context.particle_spacing));
    const bool uniform = gives(given, "thickness_m");
    if (release.thickness_raster && drawn && !uniform) {
        return Error{
            drawn.ring ? "thickness_m: missing; the release has a raster of thicknesses, a new outline needs one value"
                       : "move_m: the release has a raster of thicknesses, which stays where it is; give thickness_m"};
    }
    TALUS_TRY(redraw(drawn, terrain, true, release.patches));
    if (uniform) {
        release.thickness_raster.reset();
        for (terrain::ReleasePatch& patch : release.patches) patch.thickness = *release.spec.thickness;
    }
    TALUS_TRY(check_overlaps(release, put.setup, put.existing));
    release.volume = release_volume(terrain, release);
    const double smallest = std::pow(put.context.particle_spacing, 3);
    if (release.volume < smallest) {
        return Error{fmt::format("polygon: holds {:.3g} m3; it must be at least one particle, {:.3g} m3",
                                 release.volume, smallest)};
    }
    return {};
}

std::string Releases::told(const Entry& release, const Put<Entry>& put) {
    const double volume = release.body->volume;
    if (put.existing == nullptr) return fmt::format(": {:.0f} m3, waiting to be triggered", volume);
    return fmt::format(": {:.0f} m3 -> {:.0f} m3{}", put.existing->body->volume, volume,
                       put.context.has_begun(put.existing->id) ? " from the next restart, its debris is moving" : "");
}

}  // namespace talus::twin
