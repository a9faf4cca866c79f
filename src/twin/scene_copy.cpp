#include "twin/scene_copy.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "params/scene_text.hpp"
#include "twin/kinds.hpp"
#include "twin/scenario_parts.hpp"
#include "twin/section_values.hpp"

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

/// Of the scene: its section of this entry, and its body; nullptr: it has none.
template <class Spec, class Body>
struct Given {
    const Spec* spec = nullptr;
    const Body* body = nullptr;
};
template <class Entry, class Spec>
Given<Spec, typename Entry::Body> given_of(const Entry& entry, const std::vector<Spec>& specs,
                                           const std::vector<typename Entry::Body>& bodies) {
    const auto index = static_cast<std::size_t>(entry.scene_index);
    if (entry.scene_index < 0 || index >= specs.size() || index >= bodies.size()) return {};
    return {&specs[index], &bodies[index]};
}

std::string add_layer(DrawnLayer layer, SceneCopy& copy) {
    copy.layers.push_back(std::move(layer));
    return copy.layers.back().name;
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

void put_buildings(const Setup& setup, params::SceneSpec& spec, SceneCopy& copy) {
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
    section.layer = add_layer(std::move(layer), copy);
    section.name_attribute = "name";
    if (heights) section.height_attribute = "height_m";
    if (resistances) section.resistance_attribute = "resistance_Pa";
}

std::string polygon_text(const Ring& ring) {
    std::string text;
    for (const PlanPoint& p : ring) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", p.x, p.y);
    return text;
}

/// One of the scene that has not been moved keeps the file or the raster of its section.
void put_zones(const Setup& setup, const scene::Scene& scene, params::SceneSpec& spec, SceneCopy& copy) {
    const std::vector<params::ZoneSpec> given = std::exchange(spec.zones, {});
    for (const ZoneSetup& zone : setup.zones) {
        const scene::Zone& body = *zone.body;
        params::ZoneSpec section = body.spec;
        const auto [was, in_scene] = given_of(zone, given, scene.zones);
        if (was != nullptr && in_scene->outline == body.outline && in_scene->cells == body.cells) {
            section.file = was->file;
            section.layer = was->layer;
            section.polygon = was->polygon;
            section.raster = was->raster;
        } else {
            section.file = section.layer = section.polygon = section.raster = "";
            if (body.outline.size() == 1 && body.outline.front().holes.empty()) {
                section.polygon = polygon_text(body.outline.front().outer);
            } else {
                DrawnLayer layer{fmt::format("zone {}", spec.zones.size() + 1), {{"name", true}}, {}};
                layer.features.push_back({body.outline, {}, {section.name}});
                section.file = SceneCopy::drawn_file;
                section.layer = add_layer(std::move(layer), copy);
            }
        }
        spec.zones.push_back(std::move(section));
    }
}

/// Polygons with their thickness, as it is after the shift and the volume of the scene.
void put_releases(const Setup& setup, const scene::Scene& scene, params::SceneSpec& spec, SceneCopy& copy,
                  std::string& header) {
    const std::vector<params::ReleaseSpec> given = std::exchange(spec.releases, {});
    for (const ReleaseSetup& release : setup.releases) {
        const terrain::Release& body = *release.body;
        if (std::isinf(body.spec.start_time)) {
            header += fmt::format("\nLeft out: release \"{}\", which was not triggered.", body.name);
            continue;
        }
        params::ReleaseSpec section = body.spec;
        section.name = body.name;
        const auto [was, in_scene] = given_of(release, given, scene.releases);
        const bool raster = body.thickness_raster.has_value();
        if (was != nullptr) {  // its paths are whole
            section.file = was->file;
            section.layer = was->layer;
            section.thickness_raster = was->thickness_raster;
            section.pore_pressure_hydrograph = body.water.empty() ? "" : was->pore_pressure_hydrograph;
        }
        if (was != nullptr && raster == in_scene->thickness_raster.has_value() &&
            (raster || body.patches == in_scene->patches)) {
            section.thickness = was->thickness;
            section.thickness_attribute = was->thickness_attribute;
            section.volume = was->volume;
        } else {
            DrawnLayer layer{fmt::format("release {}", spec.releases.size() + 1), {{"thickness_m"}}, {}};
            for (const terrain::ReleasePatch& patch : body.patches) {
                layer.features.push_back({{patch.polygon}, {}, {patch.thickness}});
            }
            section.thickness.reset();
            section.volume.reset();
            section.thickness_raster = "";
            section.shift_along = section.shift_across = 0;
            section.thickness_attribute = "thickness_m";
            section.file = SceneCopy::drawn_file;
            section.layer = add_layer(std::move(layer), copy);
        }
        spec.releases.push_back(std::move(section));
    }
}

std::string hydrograph_text(const terrain::Inflow& inflow) {
    const nlohmann::json rows = list_json(inflow.hydrograph);
    std::vector<std::string> columns;
    for (const auto& [key, value] : rows.front().items()) {
        if (!value.is_null()) columns.push_back(key);
    }
    std::string text = fmt::format("{}\n", fmt::join(columns, ","));
    for (const nlohmann::json& row : rows) {
        std::string line;
        for (const std::string& key : columns) line += (line.empty() ? "" : ",") + row[key].dump();
        text += line + "\n";
    }
    return text;
}

void put_inflows(const Setup& setup, const scene::Scene& scene, params::SceneSpec& spec, SceneCopy& copy) {
    const std::vector<params::InflowSpec> given = std::exchange(spec.inflows, {});
    for (const InflowSetup& inflow : setup.inflows) {
        const terrain::Inflow& body = *inflow.body;
        params::InflowSpec section = body.spec;
        section.name = body.name;
        section.line.clear();
        section.polygon.clear();
        section.file = section.layer = section.polygon_file = "";
        if (!body.over_area()) {
            section.line = {body.from, body.to};
        } else if (body.area.size() == 1 && body.area.front().holes.empty()) {
            section.polygon = body.area.front().outer;
        } else {
            section.polygon_file = SceneCopy::drawn_file;
            DrawnLayer layer{fmt::format("inflow {}", spec.inflows.size() + 1), {{"name", true}}, {}};
            layer.features.push_back({body.area, {}, {body.name}});
            section.layer = add_layer(std::move(layer), copy);
        }
        const auto [was, in_scene] = given_of(inflow, given, scene.inflows);
        if (was != nullptr && in_scene->hydrograph == body.hydrograph) {
            section.hydrograph = was->hydrograph;
        } else {
            section.hydrograph = fmt::format("hydrograph_{}.csv", spec.inflows.size() + 1);
            copy.tables.push_back({section.hydrograph, hydrograph_text(body)});
        }
        spec.inflows.push_back(std::move(section));
    }
}

/// One whose polygons are those of the scene keeps their file; a raster stays in any case.
void put_beds(const Setup& setup, const scene::Scene& scene, params::SceneSpec& spec, SceneCopy& copy) {
    const std::vector<params::BedSpec> given = std::exchange(spec.beds, {});
    for (const BedSetup& bed : setup.beds) {
        const scene::BedLayer& body = *bed.body;
        params::BedSpec section = body.spec;
        const auto [was, in_scene] = given_of(bed, given, scene.bed_layers);
        const bool raster = body.depth_raster != nullptr;
        if (was != nullptr) {
            section.file = was->file;
            section.layer = was->layer;
        }
        section.depth_raster = raster && was != nullptr ? was->depth_raster : "";
        if (was != nullptr && body.parts == in_scene->parts && raster == (in_scene->depth_raster != nullptr)) {
            section.depth = body.parts.empty() ? body.spec.depth : was->depth;
            section.depth_attribute = was->depth_attribute;
        } else if (!body.parts.empty()) {
            DrawnLayer layer{fmt::format("bed {}", spec.beds.size() + 1), {{"depth_m"}}, {}};
            for (const scene::BedLayer::Part& part : body.parts) {
                layer.features.push_back({{part.polygon}, {}, {part.depth}});
            }
            section.depth.reset();
            section.depth_attribute = raster ? "" : "depth_m";
            section.file = SceneCopy::drawn_file;
            section.layer = add_layer(std::move(layer), copy);
        }
        spec.beds.push_back(std::move(section));
    }
}

/// Of releases and inflows that are there; `header` names the others.
void keep_triggers(const Setup& setup, params::SceneSpec& spec, std::string& header) {
    const auto lacks = [](const std::string& name, const auto& entries) {
        return !name.empty() && std::none_of(entries.begin(), entries.end(), [&](const auto& entry) {
            if constexpr (requires { entry.body->spec.start_time; }) {
                if (std::isinf(entry.body->spec.start_time)) return false;
            }
            return entry.body->name == name;
        });
    };
    std::erase_if(spec.triggers, [&](const params::TriggerSpec& trigger) {
        if (!lacks(trigger.release, setup.releases) && !lacks(trigger.inflow, setup.inflows)) return false;
        header += fmt::format("\nLeft out: trigger \"{}\", whose release or inflow is not in the scene.", trigger.name);
        return true;
    });
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

Result<SceneCopy> scene_copy(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                             const Setup& setup, const scene::Scene& scene) {
    TALUS_ASSIGN(params::SceneSpec spec, scene::parse_scene(file, overrides));
    SceneCopy copy;
    std::string header = "Written by the live twin: the scene as it was changed in the page.";
    if (!same_material(setup.material, scene.spec.material)) spec.material = setup.material;
    if (!as_in_scene<Releases>(setup, scene)) put_releases(setup, scene, spec, copy, header);
    if (!as_in_scene<Inflows>(setup, scene)) put_inflows(setup, scene, spec, copy);
    if (!as_in_scene<Beds>(setup, scene)) put_beds(setup, scene, spec, copy);
    if (!as_in_scene<Barriers>(setup, scene)) put_barriers(setup, spec);
    if (!as_in_scene<Buildings>(setup, scene)) put_buildings(setup, spec, copy);
    if (!as_in_scene<Zones>(setup, scene)) put_zones(setup, scene, spec, copy);
    spec.gauges = gauge_specs(setup);
    for (const TableKind kind : {TableKind::observation, TableKind::trigger, TableKind::alarm}) {
        put_entries(spec, kind, bodies_of(setup.tables(kind)));
    }
    keep_triggers(setup, spec, header);
    keep_alarms(setup, spec, header);
    if (spec.releases.empty() && spec.inflows.empty()) {
        return Error{
            "the scene has no debris: no release was triggered, and there is no inflow; trigger a release first"};
    }
    copy.text = params::write_short_scene(spec, header);
    return Result<SceneCopy>(std::move(copy));
}

}  // namespace

std::function<Result<SceneCopy>(const std::filesystem::path&, const std::vector<std::string>&)> scene_copy_of(
    const Scenario& scenario) {
    Setup setup = scenario.run().setup();
    for (ReleaseSetup& release : setup.releases) {
        // One that was drawn has no start time but the one at which it was triggered.
        if (!std::isinf(release.body->spec.start_time)) continue;
        terrain::Release body = *release.body;
        body.spec.start_time = scenario.run().start_time_of(release.id);
        release.body = std::make_shared<const terrain::Release>(std::move(body));
    }
    return [setup = std::move(setup), scene = scenario.parts().scene](
               const std::filesystem::path& file, const std::vector<std::string>& overrides) -> Result<SceneCopy> {
        return scene_copy(file, overrides, setup, *scene);
    };
}

}  // namespace talus::twin
