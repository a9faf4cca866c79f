#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "scene/load.hpp"

namespace talus::scene {
namespace {

/// `path`: "trigger[0].release"; `what`: "release".
template <class Entry>
Status check_name(const ParsedScene& parsed, const std::string& path, const std::string& name, const char* what,
                  const std::vector<Entry>& entries) {
    if (name.empty()) return {};
    std::vector<std::string> names;
    names.reserve(entries.size());
    for (const Entry& entry : entries) names.push_back(entry.name);
    const auto found = std::count(names.begin(), names.end(), name);
    if (found == 1) return {};
    const std::string begin = fmt::format("{} = \"{}\" is ", parsed.at(path), one_line(name, 80));
    if (found > 1) return Error{fmt::format("{}refused; {} {}s have that name", begin, found, what)};
    const std::string nearest = params::nearest_word(name, names);
    return Error{fmt::format("{}no {} of the scene; {}", begin, what,
                             nearest.empty() ? "it has none" : "nearest name: " + nearest)};
}

Status check_trigger(const ParsedScene& parsed, const Scene& scene, std::size_t index) {
    const params::TriggerSpec& trigger = scene.spec.triggers[index];
    const std::string at = fmt::format("trigger[{}].", index);
    TALUS_TRY(check_name(parsed, at + "release", trigger.release, "release", scene.releases));
    TALUS_TRY(check_name(parsed, at + "inflow", trigger.inflow, "inflow", scene.inflows));
    const auto release = std::find_if(scene.releases.begin(), scene.releases.end(),
                                      [&](const terrain::Release& r) { return r.name == trigger.release; });
    if (!trigger.volume_limit || !release->thickness_raster) return {};
    return Error{
        fmt::format("{} is refused; release \"{}\" has a raster of thicknesses, so a message cannot set its "
                    "volume",
                    parsed.at(at + "volume_limit_m3"), one_line(trigger.release, 80))};
}

Status check_alarm(const ParsedScene& parsed, const Scene& scene, std::size_t index) {
    const params::AlarmSpec& alarm = scene.spec.alarms[index];
    const std::string at = fmt::format("alarm[{}].", index);
    TALUS_TRY(check_name(parsed, at + "structure", alarm.structure, "building or barrier", scene.buildings));
    if (alarm.chainage && !(*alarm.chainage <= scene.flow_path.length())) {
        return Error{fmt::format("{} = {:.6g} lies beyond the flow path, which is {:.1f} m long",
                                 parsed.at(at + "chainage_m"), *alarm.chainage, scene.flow_path.length())};
    }
    if (alarm.x && std::isnan(scene.terrain.elevation_at({*alarm.x, *alarm.y}))) {
        return Error{fmt::format("{}: {} is not on the terrain, {}", parsed.at(at + "x_m"),
                                 place_text({*alarm.x, *alarm.y}), extent_text(covered_extent(scene.terrain)))};
    }
    if (!alarm.distance && !alarm.lead_time) return {};
    const std::string key = at + (alarm.distance ? "distance_m" : "lead_time_s");
    if (scene.flow_path.empty()) return Error{parsed.at(key) + ": needs a flow path, and the scene has none"};
    if (alarm.structure.empty()) return {};
    const auto structure = std::find_if(scene.buildings.begin(), scene.buildings.end(),
                                        [&](const terrain::Building& b) { return b.name == alarm.structure; });
    if (first_chainage(scene.flow_path, structure->footprint)) return {};
    return Error{
        fmt::format("{}: {} lies outside the flow path's corridor, {:.6g} m wide; name a chainage_m, or give a "
                    "pressure or a depth",
                    parsed.at(key), one_line(alarm.structure, 80), scene.flow_path.corridor_width())};
}

}  // namespace

Status check_alerts(const ParsedScene& parsed, const Scene& scene) {
    for (std::size_t i = 0; i < scene.spec.triggers.size(); ++i) TALUS_TRY(check_trigger(parsed, scene, i));
    for (std::size_t i = 0; i < scene.spec.alarms.size(); ++i) TALUS_TRY(check_alarm(parsed, scene, i));
    return {};
}

}  // namespace talus::scene
