#include "twin/setup.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "twin/kinds.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {
namespace {

/// The specification of a release without its thickness, which is in its patches.
params::ReleaseSpec beside_thickness(params::ReleaseSpec spec) {
    spec.name.clear();
    spec.thickness.reset();
    spec.volume.reset();
    spec.thickness_attribute.clear();
    spec.thickness_raster.clear();
    return spec;
}

}  // namespace

std::vector<TableSetup>& Setup::tables(TableKind kind) {
    return kind == TableKind::observation ? observations : kind == TableKind::trigger ? triggers : alarms;
}

const std::vector<TableSetup>& Setup::tables(TableKind kind) const {
    return kind == TableKind::observation ? observations : kind == TableKind::trigger ? triggers : alarms;
}

std::vector<params::TriggerSpec> triggers_of(const Setup& setup) {
    params::SceneSpec spec;
    put_entries(spec, TableKind::trigger, bodies_of(setup.triggers));
    return std::move(spec.triggers);
}

void take_tables(Setup& setup, NextNumbers& next, const Setup& from, const NextNumbers& from_next) {
    setup.observations = from.observations;
    setup.triggers = from.triggers;
    setup.alarms = from.alarms;
    next.observation = from_next.observation;
    next.trigger = from_next.trigger;
    next.alarm = from_next.alarm;
}

Setup setup_of(const scene::Scene& scene, NextNumbers& next) {
    Setup setup;
    setup.material = scene.spec.material;
    for_each_kind([&]<class Kind>(Kind) {
        int index = -1;
        for (const auto& body : Kind::in_scene(scene)) {
            ++index;
            if (!Kind::holds(body)) continue;
            typename Kind::Entry entry;
            entry.id = fmt::format("{}-{}", Kind::name, (next.*Kind::number)++);
            entry.body = std::make_shared<const typename Kind::Body>(body);
            entry.scene_index = index;
            entry.as_in_scene = true;
            Kind::measure(entry, scene.terrain);
            (setup.*Kind::entries).push_back(std::move(entry));
        }
    });
    return setup;
}

scene::Scene scene_of(const scene::Scene& scene, const Setup& setup) {
    scene::Scene changed = scene;
    changed.spec.material = setup.material;
    changed.releases = bodies_of(setup.releases);
    changed.buildings = bodies_of(setup.buildings);
    for (const BarrierSetup& barrier : setup.barriers) changed.buildings.push_back(*barrier.body);
    changed.inflows = bodies_of(setup.inflows);
    changed.gauges = bodies_of(setup.gauges);
    changed.zones = bodies_of(setup.zones);
    scene::ZonesOnTerrain on_terrain = zones_on_terrain(changed.zones, changed.terrain);
    changed.cover = std::move(on_terrain.cover);
    changed.zone_at = std::move(on_terrain.zone_at);
    changed.spec.zones.clear();
    for (const scene::Zone& zone : changed.zones) changed.spec.zones.push_back(zone.spec);
    changed.bed_layers = bodies_of(setup.beds);
    changed.bed = lay_bed(changed.bed_layers, changed.terrain);
    changed.spec.beds.clear();
    for (const scene::BedLayer& layer : changed.bed_layers) changed.spec.beds.push_back(layer.spec);
    for (const TableKind kind : {TableKind::observation, TableKind::trigger, TableKind::alarm}) {
        put_entries(changed.spec, kind, bodies_of(setup.tables(kind)));
    }
    return changed;
}

bool same_material(const params::MaterialSpec& a, const params::MaterialSpec& b) {
    params::SceneSpec one, other;
    one.material = a;
    other.material = b;
    const auto& parameters = params::find_section("material")->parameters;
    return std::all_of(parameters.begin(), parameters.end(), [&](const params::Parameter& parameter) {
        const params::ParameterValue p = parameter.get(one, 0), q = parameter.get(other, 0);
        const auto *x = std::get_if<double>(&p), *y = std::get_if<double>(&q);
        return p.index() == q.index() && (x == nullptr || *x == *y);
    });
}

bool same_shape(const terrain::Release& a, const terrain::Release& b) {
    const auto& r = a.thickness_raster;
    const auto& s = b.thickness_raster;
    const auto same_value = [](float p, float q) { return p == q || (p != p && q != q); };
    const bool same_raster =
        r.has_value() == s.has_value() &&
        (!r || (r->geometry == s->geometry &&
                std::equal(r->values.begin(), r->values.end(), s->values.begin(), s->values.end(), same_value)));
    return beside_thickness(a.spec) == beside_thickness(b.spec) && same_raster && a.patches == b.patches;
}

bool same_shape(const terrain::Building& a, const terrain::Building& b) {
    const auto values = [](const terrain::Building& building) -> const params::BuildingSpec& { return building; };
    return a.barrier == b.barrier && a.resistance == b.resistance && values(a) == values(b) &&
           a.roof_elevation == b.roof_elevation && a.part_roof_elevations == b.part_roof_elevations &&
           a.footprint == b.footprint;
}

bool same_shape(const scene::Zone& a, const scene::Zone& b) {
    return values_json(a.spec) == values_json(b.spec) && a.cells == b.cells && a.outline == b.outline;
}

bool same_shape(const scene::BedLayer& a, const scene::BedLayer& b) {
    return values_json(a.spec) == values_json(b.spec) && a.depth_raster == b.depth_raster && a.parts == b.parts;
}

bool same_shape(const terrain::Inflow& a, const terrain::Inflow& b) {
    return values_json(a.spec) == values_json(b.spec) && a.from == b.from && a.to == b.to && a.area == b.area &&
           a.hydrograph == b.hydrograph;
}

bool same_shape(const terrain::Gauge& a, const terrain::Gauge& b) {
    return a.at == b.at && a.name == b.name;
}

bool begin_alike(const Setup& a, const Setup& b) {
    return same_shapes(a.beds, b.beds) && same_shapes(a.inflows, b.inflows) && same_shapes(a.gauges, b.gauges);
}

bool move_alike(const Setup& a, const Setup& b) {
    return same_material(a.material, b.material) && same_shapes(a.releases, b.releases) &&
           std::equal(a.releases.begin(), a.releases.end(), b.releases.begin(),
                      [](const ReleaseSetup& p, const ReleaseSetup& q) { return p.triggered == q.triggered; }) &&
           same_shapes(a.barriers, b.barriers) && same_shapes(a.buildings, b.buildings) &&
           same_shapes(a.zones, b.zones) && same_shapes(a.beds, b.beds) && same_shapes(a.inflows, b.inflows);
}

const std::vector<const params::Parameter*>& live_parameters() {
    static const std::vector<const params::Parameter*> found = [] {
        std::vector<const params::Parameter*> list;
        for (const params::Parameter& parameter : params::find_section("material")->parameters) {
            if (!parameter.live.empty()) list.push_back(&parameter);
        }
        return list;
    }();
    return found;
}

std::string label_of(const params::Parameter& parameter) {
    std::string label = parameter.key;
    if (!parameter.unit.empty()) label.erase(label.rfind('_'));
    for (char& c : label) {
        if (c == '_') c = ' ';
    }
    return label;
}

double value_in_force(const params::MaterialSpec& material, const params::Parameter& parameter, double viscosity) {
    params::SceneSpec spec;
    spec.material = material;
    if (parameter.key == "viscosity" && material.kinematic_viscosity) return viscosity;
    const params::ParameterValue value = parameter.get(spec, 0);
    if (const double* number = std::get_if<double>(&value)) return *number;
    if (parameter.key == "laminar_viscosity_m2ps") return params::laminar_viscosity_of(material);
    if (parameter.key == "internal_friction_coefficient") return params::internal_friction_of(material);
    if (parameter.key == "building_friction_coefficient") return material.friction_coefficient;
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace talus::twin
