#include "scene/options.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"

namespace talus::scene {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whether a barrier or zone is there: no option names it, or the one that is chosen does.
bool in_force(const params::SceneSpec& spec, std::vector<std::string> params::OptionSpec::*list,
              const std::string& name) {
    bool named = false;
    for (const params::OptionSpec& option : spec.options) {
        if (!contains(option.*list, name)) continue;
        if (option.name == spec.scene.option) return true;
        named = true;
    }
    return !named;
}

void leave_out_zones(Scene& scene) {
    std::vector<Zone> zones;
    std::vector<params::ZoneSpec> specs;
    for (std::size_t k = 0; k < scene.zones.size(); ++k) {
        if (!in_force(scene.spec, &params::OptionSpec::zones, scene.zones[k].spec.name)) continue;
        zones.push_back(std::move(scene.zones[k]));
        specs.push_back(std::move(scene.spec.zones[k]));
    }
    if (zones.size() < scene.zones.size()) {
        ZonesOnTerrain on_terrain = zones_on_terrain(zones, scene.terrain);
        scene.cover = std::move(on_terrain.cover);
        scene.zone_at = std::move(on_terrain.zone_at);
    }
    scene.zones = std::move(zones);
    scene.spec.zones = std::move(specs);
}

void leave_out_barriers(Scene& scene) {
    const std::vector<params::BarrierSpec> all = std::move(scene.spec.barriers);
    const std::vector<std::size_t> all_sections = std::move(scene.barrier_sections);
    std::vector<terrain::Building> structures = std::move(scene.buildings);
    const std::size_t first = structures.size() - all_sections.size();
    scene.spec.barriers.clear();
    scene.barrier_sections.clear();
    scene.buildings.assign(std::make_move_iterator(structures.begin()),
                           std::make_move_iterator(structures.begin() + static_cast<std::ptrdiff_t>(first)));
    std::vector<std::string> gone;
    std::size_t line = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::string name = all[k].name.empty() ? fmt::format("barrier {}", k + 1) : all[k].name;
        const bool stands = in_force(scene.spec, &params::OptionSpec::barriers, name);
        for (; line < all_sections.size() && all_sections[line] == k; ++line) {
            terrain::Building& barrier = structures[first + line];
            if (!stands) {
                gone.push_back(barrier.name);
                continue;
            }
            scene.barrier_sections.push_back(scene.spec.barriers.size());
            scene.buildings.push_back(std::move(barrier));
        }
        if (!stands) continue;
        scene.spec.barriers.push_back(all[k]);
        scene.spec.barriers.back().name = name;
    }
    std::erase_if(scene.spec.barrier_openings,
                  [&](const params::BarrierOpeningSpec& opening) { return contains(gone, opening.barrier); });
}

Status check_buildings(const ParsedScene& parsed, const Scene& scene) {
    std::vector<std::string> names;
    for (std::size_t b = 0; b + scene.barrier_sections.size() < scene.buildings.size(); ++b) {
        names.push_back(scene.buildings[b].name);
    }
    for (std::size_t k = 0; k < scene.spec.options.size(); ++k) {
        for (const std::string& name : scene.spec.options[k].removed_buildings) {
            if (contains(names, name)) continue;
            return Error{
                fmt::format("{}: there is no building \"{}\"; buildings: {}",
                            parsed.at(fmt::format("option[{}].removed_buildings", k)), one_line(name, 80),
                            names.empty() ? "none" : one_line(fmt::format("{}", fmt::join(names, ", ")), 300))};
        }
    }
    return {};
}

/// Barriers stay behind the buildings; their sections are by order.
void remove_buildings(const std::vector<std::string>& removed, Scene& scene) {
    const std::size_t own = scene.buildings.size() - scene.barrier_sections.size();
    std::vector<terrain::Building> kept;
    for (std::size_t b = 0; b < scene.buildings.size(); ++b) {
        if (b < own && contains(removed, scene.buildings[b].name)) continue;
        kept.push_back(std::move(scene.buildings[b]));
    }
    scene.buildings = std::move(kept);
}

}  // namespace

Status apply_option(const ParsedScene& parsed, Scene& scene) {
    if (scene.spec.options.empty()) return {};
    TALUS_TRY(check_buildings(parsed, scene));
    leave_out_zones(scene);
    leave_out_barriers(scene);
    for (const params::OptionSpec& option : scene.spec.options) {
        if (option.name != scene.spec.scene.option) continue;
        remove_buildings(option.removed_buildings, scene);
        scene.notes.push_back(fmt::format("option: \"{}\" is in force", one_line(option.name, 80)));
        return {};
    }
    scene.notes.emplace_back("option: none is in force; what [[option]] names is left out");
    return {};
}

}  // namespace talus::scene
