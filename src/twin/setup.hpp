#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "core/geometry.hpp"
#include "params/fields.hpp"
#include "params/spec.hpp"
#include "scene/bed_layer.hpp"
#include "scene/scene.hpp"
#include "scene/zone.hpp"
#include "terrain/buildings.hpp"
#include "terrain/gauge.hpp"
#include "terrain/inflow.hpp"
#include "terrain/release.hpp"
#include "twin/table_entry.hpp"

/// The part of a run that users can change during the run: a plain value. Bodies are shared between setups, so copies
/// are cheap.
namespace talus::twin {

/// Something of a setup: what it is, and where it comes from.
template <class Of>
struct Entry {
    using Body = Of;

    std::string id;
    std::shared_ptr<const Body> body;
    int scene_index = -1;      ///< in the scene; -1: created in the page
    bool as_in_scene = false;  ///< of the scene, and its body not changed
};

struct ReleaseSetup : Entry<terrain::Release> {  ///< a drawn one has no start time (infinity)
    bool triggered = false;                      ///< in the page, regardless of its start time
};

struct BarrierSetup : Entry<terrain::Building> {  ///< with its Building::barrier
    [[nodiscard]] const params::BarrierSpec& shape() const { return *body->barrier; }
};

struct BuildingSetup : Entry<terrain::Building> {};

/// `area`, `amount`: of the body, on the terrain.
struct ZoneSetup : Entry<scene::Zone> {
    double area = 0;  ///< m2 in plan
};

struct BedSetup : Entry<scene::BedLayer> {
    scene::BedAmount amount;
};

using InflowSetup = Entry<terrain::Inflow>;
using GaugeSetup = Entry<terrain::Gauge>;

/// A text that people have pinned to a place; it does not affect the run.
struct Note {
    std::string name;  ///< the text
    PlanPoint at;
};
using NoteSetup = Entry<Note>;

/// An observation, a trigger or an alarm.
using TableSetup = Entry<TableEntry>;

struct Setup {
    params::MaterialSpec material;
    std::vector<ReleaseSetup> releases;
    std::vector<BarrierSetup> barriers;
    std::vector<BuildingSetup> buildings;
    std::vector<ZoneSetup> zones;  ///< later ones override earlier ones
    std::vector<BedSetup> beds;    ///< later ones override earlier ones; these, inflows and gauges apply from time 0
    std::vector<InflowSetup> inflows;
    std::vector<GaugeSetup> gauges;
    std::vector<NoteSetup> notes;
    std::vector<TableSetup> observations, triggers, alarms;

    [[nodiscard]] std::vector<TableSetup>& tables(TableKind kind);
    [[nodiscard]] const std::vector<TableSetup>& tables(TableKind kind) const;
};

/// Numbers of the next new ids; an id is never used twice.
struct NextNumbers {
    int release = 1, barrier = 1, building = 1, zone = 1, bed = 1, inflow = 1, gauge = 1, note = 1, observation = 1,
        trigger = 1, alarm = 1;
};

/// The scene as it was loaded; `next` is set to follow it.
[[nodiscard]] Setup setup_of(const scene::Scene& scene, NextNumbers& next);

/// Of the setup, as the scene has them.
[[nodiscard]] std::vector<params::TriggerSpec> triggers_of(const Setup& setup);

/// The observations, triggers and alarms of another scenario of the scene, with their numbers.
void take_tables(Setup& setup, NextNumbers& next, const Setup& from, const NextNumbers& from_next);

/// The scene with the parts of a setup instead of its own.
[[nodiscard]] scene::Scene scene_of(const scene::Scene& scene, const Setup& setup);

/// The entry of that id; nullptr: none.
template <class Entry>
[[nodiscard]] auto* find_id(Entry& entries, const std::string& id) {
    for (auto& entry : entries) {
        if (entry.id == id) return &entry;
    }
    return static_cast<decltype(&entries.front())>(nullptr);
}

/// The bodies of entries, in their order.
template <class Entry>
[[nodiscard]] auto bodies_of(const std::vector<Entry>& entries) {
    std::vector<std::remove_cvref_t<decltype(*entries.front().body)>> bodies;
    bodies.reserve(entries.size());
    for (const Entry& entry : entries) bodies.push_back(*entry.body);
    return bodies;
}

/// Whether every number of the section is the same in both, and given in both or neither.
[[nodiscard]] bool same_material(const params::MaterialSpec& a, const params::MaterialSpec& b);

/// Whether two bodies are the same except for their names.
[[nodiscard]] bool same_shape(const terrain::Release& a, const terrain::Release& b);
[[nodiscard]] bool same_shape(const terrain::Building& a, const terrain::Building& b);
[[nodiscard]] bool same_shape(const scene::Zone& a, const scene::Zone& b);
[[nodiscard]] bool same_shape(const scene::BedLayer& a, const scene::BedLayer& b);
[[nodiscard]] bool same_shape(const terrain::Inflow& a, const terrain::Inflow& b);
/// The same place and the same name, under which a run has its readings.
[[nodiscard]] bool same_shape(const terrain::Gauge& a, const terrain::Gauge& b);
template <class Body>
[[nodiscard]] bool same_shape(const std::shared_ptr<const Body>& a, const std::shared_ptr<const Body>& b) {
    return a == b || same_shape(*a, *b);
}

/// Whether this holds for two lists, pair by pair.
template <class Entry>
[[nodiscard]] bool same_shapes(const std::vector<Entry>& a, const std::vector<Entry>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Entry& p, const Entry& q) { return same_shape(p.body, q.body); });
}

/// Whether runs of both would begin with the same beds, inflows and gauges.
[[nodiscard]] bool begin_alike(const Setup& a, const Setup& b);

/// Whether debris moves in the same way with both: they differ in names, gauges, notes, observations,
/// triggers and alarms at most.
[[nodiscard]] bool move_alike(const Setup& a, const Setup& b);

/// The keys of the material section that can change while debris moves, as declared for the scene file.
[[nodiscard]] const std::vector<const params::Parameter*>& live_parameters();

/// "friction coefficient", from "friction_coefficient"; without the unit that the key ends with.
[[nodiscard]] std::string label_of(const params::Parameter& parameter);

/// The effective value, in the unit of the key: one that is not set separately is that of the key it follows; NaN where
/// it follows nothing. `viscosity`: as make_model takes it, where the scene gives it as kinematic viscosity.
[[nodiscard]] double value_in_force(const params::MaterialSpec& material, const params::Parameter& parameter,
                                    double viscosity);

}  // namespace talus::twin
