#include "twin/scene_copy.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/scene_text.hpp"
#include "twin/kinds.hpp"

namespace talus::twin {
namespace {

/// Whether a setup has exactly what the scene has of this kind.
template <class Kind>
bool as_in_scene(const Setup& setup, const scene::Scene& scene) {
    const auto& entries = setup.*Kind::entries;
    const auto& bodies = Kind::in_scene(scene);
    const auto count = std::count_if(bodies.begin(), bodies.end(), [](const auto& body) { return Kind::holds(body); });
    return std::ssize(entries) == count &&
           std::all_of(entries.begin(), entries.end(), [](const auto& entry) { return entry.as_in_scene; });
}

/// A name that is not among `taken` yet; it is from now on.
std::string unlike(const std::string& name, std::vector<std::string>& taken) {
    std::string made = name;
    for (int k = 2; std::find(taken.begin(), taken.end(), made) != taken.end(); ++k) {
        made = fmt::format("{} ({})", name, k);
    }
    taken.push_back(made);
    return made;
}

std::vector<params::GaugeSpec> gauge_specs(const Setup& setup) {
    std::vector<params::GaugeSpec> specs;
    for (const GaugeSetup& gauge : setup.gauges) {
        params::GaugeSpec& spec = specs.emplace_back();
        spec.name = gauge.body->name;
        if (std::isnan(gauge.body->chainage)) {
            spec.x = gauge.body->at.x;
            spec.y = gauge.body->at.y;
        } else {
            spec.chainage = gauge.body->chainage;
        }
    }
    return specs;
}

/// Every barrier by its line: the lines of a file are one by one, too.
void put_barriers(const Setup& setup, params::SceneSpec& spec) {
    spec.barriers.clear();
    spec.barrier_openings.clear();
    std::vector<std::string> names;
    for (const BarrierSetup& barrier : setup.barriers) {
        params::BarrierSpec shape = barrier.shape();
        shape.name = unlike(barrier.body->name, names);  // openings refer to it
        for (params::BarrierOpeningSpec opening : std::exchange(shape.openings, {})) {
            opening.barrier = shape.name;
            spec.barrier_openings.push_back(std::move(opening));
        }
        spec.barriers.push_back(std::move(shape));
    }
}

geo::Attribute number_or_nothing(bool there, double value) {
    return there ? geo::Attribute(value) : geo::Attribute();
}

void put_buildings(const Setup& setup, params::SceneSpec& spec, std::vector<DrawnLayer>& layers) {
    params::BuildingsSpec& section = spec.buildings;
    section.file = section.layer = section.height_attribute = section.name_attribute = section.resistance_attribute =
        "";
    section.resistance.reset();
    if (setup.buildings.empty()) return;
    DrawnLayer layer{"buildings", {{"name", true}, {"height_m"}, {"resistance_Pa"}}, {}};
    bool heights = false, resistances = false;
    for (const BuildingSetup& building : setup.buildings) {
        const terrain::Building& body = *building.body;
        const bool known = !body.height_assumed, fails = std::isfinite(body.resistance.pressure);
        heights = heights || known;
        resistances = resistances || fails;
        layer.features.push_back(
            {body.footprint,
             {},
             {body.name, number_or_nothing(known, body.height), number_or_nothing(fails, body.resistance.pressure)}});
    }
    section.file = SceneCopy::drawn_file;
    section.layer = layer.name;
    section.name_attribute = "name";
    if (heights) section.height_attribute = "height_m";
    if (resistances) section.resistance_attribute = "resistance_Pa";
    layers.push_back(std::move(layer));
}

std::string polygon_text(const Ring& ring) {
    std::string text;
    for (const PlanPoint& p : ring) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", p.x, p.y);
    return text;
}

/// One of the scene that has not been moved keeps the file or the raster of its section.
void put_zones(const Setup& setup, const scene::Scene& scene, params::SceneSpec& spec,
               std::vector<DrawnLayer>& layers) {
    const std::vector<params::ZoneSpec> given = std::exchange(spec.zones, {});
    for (const ZoneSetup& zone : setup.zones) {
        const scene::Zone& body = *zone.body;
        params::ZoneSpec section = body.spec;
        const auto index = static_cast<std::size_t>(zone.scene_index);
        if (zone.scene_index >= 0 && index < given.size() && index < scene.zones.size() &&
            scene.zones[index].outline == body.outline && scene.zones[index].cells == body.cells) {
            section.file = given[index].file;
            section.layer = given[index].layer;
            section.polygon = given[index].polygon;
            section.raster = given[index].raster;
        } else {
            section.file = section.layer = section.polygon = section.raster = "";
            if (body.outline.size() == 1 && body.outline.front().holes.empty()) {
                section.polygon = polygon_text(body.outline.front().outer);
            } else {
                DrawnLayer layer{fmt::format("zone {}", spec.zones.size() + 1), {{"name", true}}, {}};
                layer.features.push_back({body.outline, {}, {section.name}});
                section.file = SceneCopy::drawn_file;
                section.layer = layer.name;
                layers.push_back(std::move(layer));
            }
        }
        spec.zones.push_back(std::move(section));
    }
}

/// Of structures that are there; `header` names the others.
void keep_alarms(const Setup& setup, params::SceneSpec& spec, std::string& header) {
    std::vector<std::string> known;
    for (const BarrierSetup& barrier : setup.barriers) known.push_back(barrier.body->name);
    for (const BuildingSetup& building : setup.buildings) known.push_back(building.body->name);
    std::erase_if(spec.alarms, [&](const params::AlarmSpec& alarm) {
        if (alarm.structure.empty() || std::find(known.begin(), known.end(), alarm.structure) != known.end())
            return false;
        header += fmt::format("\nLeft out: alarm \"{}\", whose structure \"{}\" is not in the scene.", alarm.name,
                              alarm.structure);
        return true;
    });
}

}  // namespace

Result<SceneCopy> scene_copy(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                             const Setup& setup, const scene::Scene& scene) {
    TALUS_ASSIGN(params::SceneSpec spec, scene::parse_scene(file, overrides));
    SceneCopy copy;
    std::string header = "Written by the live twin: the scene as it was changed in the page.";
    if (!same_material(setup.material, scene.spec.material)) spec.material = setup.material;
    if (!as_in_scene<Barriers>(setup, scene)) put_barriers(setup, spec);
    if (!as_in_scene<Buildings>(setup, scene)) put_buildings(setup, spec, copy.layers);
    if (!as_in_scene<Zones>(setup, scene)) put_zones(setup, scene, spec, copy.layers);
    spec.gauges = gauge_specs(setup);
    for (const TableKind kind : {TableKind::observation, TableKind::trigger, TableKind::alarm}) {
        put_entries(spec, kind, bodies_of(setup.tables(kind)));
    }
    keep_alarms(setup, spec, header);
    for (const auto& [same, what] : {std::pair{as_in_scene<Releases>(setup, scene), "releases"},
                                     std::pair{as_in_scene<Inflows>(setup, scene), "inflows"},
                                     std::pair{as_in_scene<Beds>(setup, scene), "beds"}}) {
        if (!same)
            header +=
                fmt::format("\nLeft out: {} that were drawn, changed or removed; they are as in the scene.", what);
    }
    copy.text = params::write_short_scene(spec, header);
    return Result<SceneCopy>(std::move(copy));
}

}  // namespace talus::twin
