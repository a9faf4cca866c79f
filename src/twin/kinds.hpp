#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "scene/scene.hpp"
#include "twin/action.hpp"
#include "twin/setup.hpp"

/// The kinds of things in a setup. Each is described once: its name, where it is, and how it is written and read. Setup
/// files, the page's answers, put and remove actions and the numbers of new ids go through all kinds. A kind has
///   body():     as a setup file has it, which is also what the page gets
///   more():     what the page gets besides
///   read():     the reverse of body(), over the body of the scene. Errors name key and value.
///   put():      changes a body, or a new one, by the keys of an action. Errors name key, value and what is allowed.
///   told():     what an action has done: the end of a sentence
///   fresh():    what a new body begins with
///   in_scene(), holds(): the bodies of a scene, and which of them are of this kind
///   measure():  sets what an entry knows about its body
namespace talus::twin {

class LiveRun;

/// The keys of a put action, without those that every action has.
template <class Entry>
struct Put {
    const nlohmann::json& given;
    const ActionContext& context;
    const Setup& setup;
    const Entry* existing;  ///< nullptr: a new one
    std::string name;       ///< as given, or as it was

    [[nodiscard]] const char* done(const char* anew) const { return existing != nullptr ? "changed" : anew; }
    [[nodiscard]] const char* from_restart() const { return context.begun ? ", from the next restart" : ""; }
};

/// Where zones from rasters lie: it takes long to find.
using ZoneBlocks = std::map<std::shared_ptr<const scene::Zone>, nlohmann::json>;

/// What the page's answers are made from.
struct Shown {
    const LiveRun& run;
    const GridGeometry& terrain;
    const ZoneBlocks& known;  ///< found before
    ZoneBlocks& blocks;       ///< of the present zones
};

/// What a file has of an entry's origin: its index in the scene, with the body only if that was changed; or the whole
/// body, with a flag; or nothing, as no scene file has such things.
enum class Origin { index, flag, none };

template <class Of>
struct KindOf {
    using Entry = Of;
    using Body = typename Entry::Body;
    static constexpr Origin origin = Origin::index;
    static constexpr bool from_time_0 = false;       ///< a change waits for the restart
    static constexpr bool in_every_file = true;      ///< false: not in older journals
    static constexpr std::size_t longest_name = 80;  ///< bytes

    static Body fresh() { return {}; }
    static std::string name_of(const Body& body) { return body.name; }
    static bool holds(const Body&) { return true; }
    static void measure(Entry&, const terrain::Terrain&) {}
    static nlohmann::json more(const Entry&, Shown&) { return nlohmann::json::object(); }
};

struct Releases : KindOf<ReleaseSetup> {
    static constexpr const char *name = "release", *list = "releases";
    static constexpr auto entries = &Setup::releases;
    static constexpr auto number = &NextNumbers::release;
    static const auto& in_scene(const scene::Scene& scene) { return scene.releases; }
    static Body fresh();
    static nlohmann::json body(const Body& release);
    static nlohmann::json more(const Entry& release, Shown& shown);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& release);
    static Status put(const Put<Entry>& put, Body& release);
    static std::string told(const Entry& release, const Put<Entry>& put);
};

struct Barriers : KindOf<BarrierSetup> {
    static constexpr const char *name = "barrier", *list = "barriers";
    static constexpr auto entries = &Setup::barriers;
    static constexpr auto number = &NextNumbers::barrier;
    static constexpr Origin origin = Origin::flag;
    static const auto& in_scene(const scene::Scene& scene) { return scene.buildings; }
    static bool holds(const Body& building) { return building.barrier.has_value(); }
    static nlohmann::json body(const Body& barrier);
    static nlohmann::json more(const Entry& barrier, Shown& shown);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& barrier);
    static Status put(const Put<Entry>& put, Body& barrier);
    static std::string told(const Entry& barrier, const Put<Entry>& put);
};

struct Buildings : KindOf<BuildingSetup> {
    static constexpr const char *name = "building", *list = "buildings";
    static constexpr auto entries = &Setup::buildings;
    static constexpr auto number = &NextNumbers::building;
    static const auto& in_scene(const scene::Scene& scene) { return scene.buildings; }
    static bool holds(const Body& building) { return !building.barrier.has_value(); }
    static nlohmann::json body(const Body& building);
    static nlohmann::json more(const Entry& building, Shown& shown);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& building);
    static Status put(const Put<Entry>& put, Body& building);
    static std::string told(const Entry& building, const Put<Entry>& put);
};

struct Zones : KindOf<ZoneSetup> {
    static constexpr const char *name = "zone", *list = "zones";
    static constexpr auto entries = &Setup::zones;
    static constexpr auto number = &NextNumbers::zone;
    static const auto& in_scene(const scene::Scene& scene) { return scene.zones; }
    static std::string name_of(const Body& zone) { return zone.spec.name; }
    static void measure(Entry& zone, const terrain::Terrain& terrain);
    static nlohmann::json body(const Body& zone);
    static nlohmann::json more(const Entry& zone, Shown& shown);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& zone);
    static Status put(const Put<Entry>& put, Body& zone);
    static std::string told(const Entry& zone, const Put<Entry>& put);
};

struct Beds : KindOf<BedSetup> {
    static constexpr const char *name = "bed", *list = "beds";
    static constexpr auto entries = &Setup::beds;
    static constexpr auto number = &NextNumbers::bed;
    static constexpr bool from_time_0 = true;
    static const auto& in_scene(const scene::Scene& scene) { return scene.bed_layers; }
    static std::string name_of(const Body& layer) { return layer.spec.name; }
    static void measure(Entry& bed, const terrain::Terrain& terrain);
    static nlohmann::json body(const Body& layer);
    static nlohmann::json more(const Entry& bed, Shown& shown);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& layer);
    static Status put(const Put<Entry>& put, Body& layer);
    static std::string told(const Entry& bed, const Put<Entry>& put);
};

struct Inflows : KindOf<InflowSetup> {
    static constexpr const char *name = "inflow", *list = "inflows";
    static constexpr auto entries = &Setup::inflows;
    static constexpr auto number = &NextNumbers::inflow;
    static constexpr bool from_time_0 = true;
    static const auto& in_scene(const scene::Scene& scene) { return scene.inflows; }
    static nlohmann::json body(const Body& inflow);
    static nlohmann::json more(const Entry& inflow, Shown& shown);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& inflow);
    static Status put(const Put<Entry>& put, Body& inflow);
    static std::string told(const Entry& inflow, const Put<Entry>& put);
};

struct Gauges : KindOf<GaugeSetup> {
    static constexpr const char *name = "gauge", *list = "gauges";
    static constexpr auto entries = &Setup::gauges;
    static constexpr auto number = &NextNumbers::gauge;
    static constexpr bool from_time_0 = true, in_every_file = false;
    static const auto& in_scene(const scene::Scene& scene) { return scene.gauges; }
    static nlohmann::json body(const Body& gauge);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& gauge);
    static Status put(const Put<Entry>& put, Body& gauge);
    static std::string told(const Entry& gauge, const Put<Entry>& put);
};

struct Notes : KindOf<NoteSetup> {
    static constexpr const char *name = "note", *list = "notes";
    static constexpr auto entries = &Setup::notes;
    static constexpr auto number = &NextNumbers::note;
    static constexpr Origin origin = Origin::none;
    static constexpr bool in_every_file = false;
    static constexpr std::size_t longest_name = 200;
    static std::vector<Body> in_scene(const scene::Scene&) { return {}; }
    static nlohmann::json body(const Body& note);
    static Status read(const nlohmann::json& file, const scene::Scene& scene, Body& note);
    static Status put(const Put<Entry>& put, Body& note);
    static std::string told(const Entry&, const Put<Entry>& put) { return std::string(" ") + put.done("pinned"); }
};

/// Observations, triggers and alarms.
struct Tables : KindOf<TableSetup> {
    static constexpr Origin origin = Origin::flag;
    static constexpr bool in_every_file = false;
    static std::string name_of(const Body& entry) { return entry.name(); }
    static nlohmann::json body(const Body& entry);
    static Status read_as(TableKind kind, const nlohmann::json& file, Body& entry);
    static Status put_as(TableKind kind, const Put<Entry>& put, Body& entry);
    static std::string told(const Entry&, const Put<Entry>& put) { return std::string(" ") + put.done("added"); }
};

template <TableKind kind>
struct TablesOf : Tables {
    static std::vector<Body> in_scene(const scene::Scene& scene) { return entries_of(scene.spec, kind); }
    static Status read(const nlohmann::json& file, const scene::Scene&, Body& entry) {
        return read_as(kind, file, entry);
    }
    static Status put(const Put<Entry>& put, Body& entry) { return put_as(kind, put, entry); }
};
struct Observations : TablesOf<TableKind::observation> {
    static constexpr const char *name = "observation", *list = "observations";
    static constexpr auto entries = &Setup::observations;
    static constexpr auto number = &NextNumbers::observation;
};
struct Triggers : TablesOf<TableKind::trigger> {
    static constexpr const char *name = "trigger", *list = "triggers";
    static constexpr auto entries = &Setup::triggers;
    static constexpr auto number = &NextNumbers::trigger;
};
struct Alarms : TablesOf<TableKind::alarm> {
    static constexpr const char *name = "alarm", *list = "alarms";
    static constexpr auto entries = &Setup::alarms;
    static constexpr auto number = &NextNumbers::alarm;
};

/// Calls `visit(Kind())` for every kind.
template <class Visit>
void for_each_kind(const Visit& visit) {
    const auto visit_all = [&]<class... Kind>(Kind... kind) { (visit(kind), ...); };
    visit_all(Releases(), Barriers(), Buildings(), Zones(), Beds(), Inflows(), Gauges(), Notes(), Observations(),
              Triggers(), Alarms());
}

/// As for_each_kind, up to the first Error.
template <class Visit>
[[nodiscard]] Status try_each_kind(const Visit& visit) {
    Status status;
    for_each_kind([&](auto kind) {
        if (status) status = visit(kind);
    });
    return status;
}

/// Particles of all sources of debris, with this inflow in place of `existing`; `spacing` in m.
[[nodiscard]] double particles_in_all(const Setup& setup, const InflowSetup* existing, const terrain::Inflow& inflow,
                                      double spacing);

}  // namespace talus::twin
