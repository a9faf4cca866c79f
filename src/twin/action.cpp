#include "twin/action.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "scene/polygons.hpp"
#include "sim/physics/viscosity.hpp"
#include "terrain/barrier.hpp"
#include "twin/json_keys.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t most_points = 500;

/// Reads one action: `edit` is the setup as it is, to be changed.
class ActionReader {
  public:
    ActionReader(const json& action, NextNumbers& next, const ActionContext& context, Edit& edit)
        : action_(action), next_(next), context_(context), edit_(edit) {}

    Status set_parameter();
    Status put_release();
    Status trigger_release();
    Status put_barrier();
    Status put_building();
    template <class Entries>
    Status remove(Entries& entries, const char* what);

  private:
    [[nodiscard]] Result<std::string> id() const;
    [[nodiscard]] static Error no_such(const std::string& id, const char* what);
    [[nodiscard]] static Error missing(const char* key, const char* what) {
        return Error{fmt::format("{}: missing; a new {} needs it", key, what)};
    }
    [[nodiscard]] double highest_viscosity() const;
    [[nodiscard]] Status check_ring(const Ring& ring, const char* key, bool whole) const;
    [[nodiscard]] Status check_overlaps(const Release& release, const std::string& own_id) const;
    /// "release-3": of a new thing; counts only when all is well.
    std::string new_id(const char* what, int& number) {
        edit_.created = fmt::format("{}-{}", what, number++);
        return edit_.created;
    }

    const json& action_;
    NextNumbers& next_;
    const ActionContext& context_;
    Edit& edit_;
};

std::string in_quotes(const std::string& name) {
    return "\"" + name + "\"";
}

std::string name_of(const ReleaseSetup& release) {
    return release.body->name;
}
std::string name_of(const BarrierSetup& barrier) {
    return barrier.body->name;
}
std::string name_of(const BuildingSetup& building) {
    return building.body->name;
}

Result<std::string> ActionReader::id() const {
    auto text = read_text(action_, "id");
    if (!text) return text.error();
    return text->value_or("");
}

Error ActionReader::no_such(const std::string& id, const char* what) {
    if (id.empty()) return Error{fmt::format("id: missing; it must name a {}", what)};
    return Error{fmt::format("id = {}: there is no such {}", shown(json(id)), what)};
}

/// What a step smooths beyond the whole difference between neighbours would drive them apart (see load_scene).
double ActionReader::highest_viscosity() const {
    const SolverSpec& solver = context_.scene.spec.solver;
    return viscosity_reference_step / solver.time_step.value_or(solver.largest_time_step);
}

Status ActionReader::set_parameter() {
    if (Status s = check_keys(action_, {"action", "key", "value"}); !s) return s;
    const auto key = read_text(action_, "key");
    if (!key) return key.error();
    const auto lever = std::find_if(levers().begin(), levers().end(), [&](const Parameter* p) {
        return key->has_value() && "material." + p->key == **key;
    });
    if (lever == levers().end()) {
        std::vector<std::string> names;
        for (const Parameter* p : levers()) names.push_back("material." + p->key);
        return Error{
            fmt::format("key = {}: must be one of {}", shown(action_.value("key", json())), fmt::join(names, ", "))};
    }
    const Parameter& parameter = **lever;
    Range range = parameter.range;
    if (parameter.key == "viscosity" && highest_viscosity() < range.high) {
        range.high = std::floor(1e4 * highest_viscosity()) / 1e4;
        range.high_included = true;
    }
    const auto value = read_number(action_, "value", range, parameter.unit);
    if (!value) return Error{fmt::format("{}: {}", **key, value.error().message)};
    const bool may_follow = !parameter.absent.empty();  // null: as what it follows
    if (!*value && (!may_follow || !action_.contains("value"))) {
        return Error{fmt::format("{}: value: missing; must be {}", **key, allowed_text(parameter))};
    }
    const bool by_stress = context_.scene.spec.solver.internal_friction == InternalFriction::stress;
    if (!by_stress && (parameter.key == "cohesion_Pa" || parameter.key == "pore_pressure_ratio")) {
        return Error{fmt::format("{}: needs solver.internal_friction = \"stress\"", **key)};
    }
    const double before = value_in_force(edit_.setup.material, parameter, context_.viscosity);
    SceneSpec spec;
    spec.material = edit_.setup.material;
    parameter.set(spec, 0, *value ? ParameterValue(**value) : ParameterValue());
    edit_.setup.material = spec.material;
    if (parameter.key == "viscosity") edit_.setup.material.kinematic_viscosity.reset();
    const double after = value_in_force(edit_.setup.material, parameter, context_.viscosity);
    const auto shown_value = [](double number) { return std::isnan(number) ? "none" : fmt::format("{:.6g}", number); };
    edit_.sentence = fmt::format("{} {} -> {}{}{}", label_of(parameter), shown_value(before), shown_value(after),
                                 parameter.unit.empty() ? "" : " ", parameter.unit);
    return {};
}

/// `whole`: all of it must lie on known ground; else some of it.
Status ActionReader::check_ring(const Ring& ring, const char* key, bool whole) const {
    if (meets_itself(ring)) return Error{fmt::format("{}: touches or crosses itself", key)};
    const Polygon polygon{ring, {}};
    if (!(plan_area(polygon) > 0)) return Error{fmt::format("{}: has no area", key)};
    const Terrain& terrain = context_.scene.terrain;
    std::optional<PlanPoint> bare;
    bool any = false;
    const auto look = [&](const PlanPoint& p) {
        const bool known = !std::isnan(terrain.elevation_at(p));
        any = any || known;
        if (!known && !bare) bare = p;
    };
    for_each_on_rings(polygon, terrain.cell() / 2, look);
    for_each_inside(polygon, terrain.cell() / 2, look);
    if (any && !(whole && bare)) return {};
    const Extent e = terrain.elevation().geometry.extent().grown(-terrain.cell() / 2);
    return Error{fmt::format(
        "{}: reaches ({:.1f}, {:.1f}), where the ground is not known; the terrain covers x {:.1f} to {:.1f}, y {:.1f} "
        "to {:.1f} at most",
        key, bare->x, bare->y, e.x_min, e.x_max, e.y_min, e.y_max)};
}

Status ActionReader::check_overlaps(const Release& release, const std::string& own_id) const {
    for (const ReleaseSetup& other : edit_.setup.releases) {
        if (other.id == own_id) continue;
        for (const ReleasePatch& theirs : other.body->patches) {
            for (const ReleasePatch& ours : release.patches) {
                const Overlap overlap = overlap_of(ours.polygon, theirs.polygon);
                if (!is_true_overlap(overlap, ours.polygon, theirs.polygon)) continue;
                return Error{fmt::format(
                    "polygon: overlaps release {} by {:.4g} m2 around ({:.1f}, {:.1f}); the same ground cannot fail "
                    "twice",
                    in_quotes(other.body->name), overlap.area, overlap.place.x, overlap.place.y)};
            }
        }
    }
    return {};
}

Status ActionReader::put_release() {
    if (Status s = check_keys(action_, {"action", "id", "name", "polygon", "thickness_m"}); !s) return s;
    const auto given_id = id();
    if (!given_id) return given_id.error();
    ReleaseSetup* existing = find_id(edit_.setup.releases, *given_id);
    if (!given_id->empty() && existing == nullptr) return no_such(*given_id, "release");
    const auto name = read_text(action_, "name");
    if (!name) return name.error();
    auto polygon = read_points(action_, "polygon", true, 3, most_points);
    if (!polygon) return polygon.error();
    const auto thickness =
        read_number(action_, "thickness_m", find_section("release")->find("thickness_m")->range, "m");
    if (!thickness) return thickness.error();
    if (existing == nullptr && !*polygon) return missing("polygon", "release");
    if (existing == nullptr && !*thickness) return missing("thickness_m", "release");

    Release release;
    if (existing != nullptr) {
        release = *existing->body;
    } else {
        release.start_time = std::numeric_limits<double>::infinity();
        release.name = fmt::format("release {}", next_.release);
    }
    release.name = name->value_or(release.name);
    if (*polygon) {
        if (Status s = check_ring(**polygon, "polygon", true); !s) return s;
        const double before = release.patches.empty() ? 0 : release.patches.front().thickness;
        if (release.thickness_raster && !*thickness) {
            return Error{
                "thickness_m: missing; the release has a raster of thicknesses, a new outline needs one value"};
        }
        release.patches = {{{std::move(**polygon), {}}, before}};
        release.thickness_raster.reset();
    }
    if (*thickness) {
        release.thickness_raster.reset();
        for (ReleasePatch& patch : release.patches) patch.thickness = **thickness;
    }
    if (Status s = check_overlaps(release, *given_id); !s) return s;
    const double volume_before = release.volume;
    release.volume = release_volume(context_.scene.terrain, release);
    const double smallest = std::pow(context_.particle_spacing, 3);
    if (release.volume < smallest) {
        return Error{fmt::format("polygon: holds {:.3g} m3; it must be at least one particle, {:.3g} m3",
                                 release.volume, smallest)};
    }
    if (existing == nullptr) {
        edit_.sentence =
            fmt::format("release {}: {:.0f} m3, waiting to be triggered", in_quotes(release.name), release.volume);
        edit_.setup.releases.push_back(
            {new_id("release", next_.release), std::make_shared<const Release>(std::move(release)), -1, false, false});
        return {};
    }
    edit_.sentence =
        fmt::format("release {}: {:.0f} m3 -> {:.0f} m3{}", in_quotes(release.name), volume_before, release.volume,
                    context_.has_begun(existing->id) ? " from the next restart, its debris is moving" : "");
    existing->body = std::make_shared<const Release>(std::move(release));
    existing->as_in_scene = false;
    return {};
}

Status ActionReader::trigger_release() {
    if (Status s = check_keys(action_, {"action", "id"}); !s) return s;
    const auto given = id();
    if (!given) return given.error();
    ReleaseSetup* release = find_id(edit_.setup.releases, *given);
    if (release == nullptr) return no_such(*given, "release");
    if (release->triggered || context_.has_begun(release->id)) {
        return Error{
            fmt::format("id = {}: release {} has already started", shown(json(*given)), in_quotes(name_of(*release)))};
    }
    release->triggered = true;
    edit_.sentence =
        fmt::format("release {} triggered: {:.0f} m3", in_quotes(name_of(*release)), release->body->volume);
    return {};
}

Status ActionReader::put_barrier() {
    if (Status s = check_keys(
            action_, {"action", "id", "name", "line", "height_m", "thickness_m", "resistance_Npm", "resistance_Pa"});
        !s) {
        return s;
    }
    const auto given_id = id();
    if (!given_id) return given_id.error();
    BarrierSetup* existing = find_id(edit_.setup.barriers, *given_id);
    if (!given_id->empty() && existing == nullptr) return no_such(*given_id, "barrier");
    const auto name = read_text(action_, "name");
    if (!name) return name.error();
    auto line = read_points(action_, "line", false, 2, most_points);
    if (!line) return line.error();
    const auto height = read_number(action_, "height_m", {.low = 0, .high = 200, .low_included = false}, "m");
    if (!height) return height.error();
    // Thinner than a particle, debris on both sides would feel each other through it.
    const double thinnest = std::ceil(100 * context_.particle_spacing / 2) / 100;
    const auto thickness = read_number(action_, "thickness_m", {.low = thinnest, .high = 100}, "m");
    if (!thickness) return thickness.error();
    constexpr Range positive{.low = 0, .low_included = false};
    const auto force = read_number(action_, "resistance_Npm", positive, "N/m");
    if (!force) return force.error();
    const auto pressure = read_number(action_, "resistance_Pa", positive, "Pa");
    if (!pressure) return pressure.error();
    BarrierSetup barrier;
    BarrierShape shape;
    std::string called = fmt::format("barrier {}", next_.barrier);
    if (existing != nullptr) {
        barrier = *existing;
        shape = existing->shape();
        called = name_of(*existing);
    } else {
        if (!*line) return missing("line", "barrier");
        if (!*height) return missing("height_m", "barrier");
        if (!*thickness) return missing("thickness_m", "barrier");
    }
    called = name->value_or(called);
    if (*line) shape.line = std::move(**line);
    if (*height) shape.crest_elevation.reset();
    shape.height = height->value_or(shape.height);
    shape.thickness = thickness->value_or(shape.thickness);
    Result<Building> body = make_barrier(context_.scene.terrain, called, shape);
    if (!body) return body.error();
    if (existing != nullptr) body->resistance = existing->body->resistance;
    body->resistance.force_per_metre = force->value_or(body->resistance.force_per_metre);
    body->resistance.pressure = pressure->value_or(body->resistance.pressure);
    const double body_height = body->height;
    barrier.body = std::make_shared<const Building>(std::move(*body));
    edit_.sentence = fmt::format("barrier {} {}: {:.1f} m long, {:.3g} m high, {:.3g} m thick", in_quotes(called),
                                 existing ? "changed" : "placed", length_of(shape.line), body_height, shape.thickness);
    if (existing != nullptr) {
        *existing = std::move(barrier);
    } else {
        barrier.id = new_id("barrier", next_.barrier);
        edit_.setup.barriers.push_back(std::move(barrier));
    }
    return {};
}

Status ActionReader::put_building() {
    if (Status s = check_keys(action_, {"action", "id", "name", "footprint", "height_m"}); !s) return s;
    const auto given_id = id();
    if (!given_id) return given_id.error();
    BuildingSetup* existing = find_id(edit_.setup.buildings, *given_id);
    if (!given_id->empty() && existing == nullptr) return no_such(*given_id, "building");
    const auto name = read_text(action_, "name");
    if (!name) return name.error();
    auto footprint = read_points(action_, "footprint", true, 3, most_points);
    if (!footprint) return footprint.error();
    const auto height =
        read_number(action_, "height_m", find_section("buildings")->find("default_height_m")->range, "m");
    if (!height) return height.error();
    if (existing == nullptr && !*footprint) return missing("footprint", "building");
    if (existing == nullptr && !*height) return missing("height_m", "building");
    Building building;
    if (existing != nullptr) {
        building = *existing->body;
    } else {
        building.name = fmt::format("building {}", next_.building);
    }
    building.name = name->value_or(building.name);
    if (*footprint) {
        if (Status s = check_ring(**footprint, "footprint", false); !s) return s;
        building.footprint = {{std::move(**footprint), {}}};
    }
    if (*height) {
        building.height = **height;
        building.height_assumed = false;
    }
    std::vector<Building> placed{building};
    place_buildings(context_.scene.terrain, placed);
    building = std::move(placed.front());
    if (!std::isfinite(building.roof_elevation)) {
        return Error{"footprint: does not stand on known ground"};
    }
    edit_.sentence = fmt::format("building {} {}: {:.3g} m high", in_quotes(building.name),
                                 existing ? "changed" : "placed", building.height);
    auto body = std::make_shared<const Building>(std::move(building));
    if (existing != nullptr) {
        existing->body = std::move(body);
        existing->as_in_scene = false;
    } else {
        edit_.setup.buildings.push_back({new_id("building", next_.building), std::move(body), -1, false});
    }
    return {};
}

template <class Entries>
Status ActionReader::remove(Entries& entries, const char* what) {
    if (Status s = check_keys(action_, {"action", "id"}); !s) return s;
    const auto given = id();
    if (!given) return given.error();
    const auto* entry = find_id(entries, *given);
    if (entry == nullptr) return no_such(*given, what);
    edit_.sentence = fmt::format("{} {} removed", what, in_quotes(name_of(*entry)));
    entries.erase(entries.begin() + (entry - entries.data()));
    return {};
}

}  // namespace

Result<std::string> action_name(const json& action) {
    if (!action.is_object()) return Error{fmt::format("the action {} must be a JSON object", shown(action))};
    auto name = read_text(action, "action");
    if (!name) return name.error();
    if (!*name) return Error{"action: missing; it must name what to do, such as set_parameter"};
    return **name;
}

Result<Edit> read_action(const json& action, const Setup& setup, NextNumbers& next, const ActionContext& context) {
    const Result<std::string> name = action_name(action);
    if (!name) return name.error();
    Edit edit{setup, "", ""};
    ActionReader reader(action, next, context, edit);
    Status done;
    if (*name == "set_parameter") {
        done = reader.set_parameter();
    } else if (*name == "put_release") {
        done = reader.put_release();
    } else if (*name == "remove_release") {
        done = reader.remove(edit.setup.releases, "release");
    } else if (*name == "trigger_release") {
        done = reader.trigger_release();
    } else if (*name == "put_barrier") {
        done = reader.put_barrier();
    } else if (*name == "remove_barrier") {
        done = reader.remove(edit.setup.barriers, "barrier");
    } else if (*name == "put_building") {
        done = reader.put_building();
    } else if (*name == "remove_building") {
        done = reader.remove(edit.setup.buildings, "building");
    } else {
        return Error{fmt::format(
            "action = {}: must be one of set_parameter, put_release, remove_release, trigger_release, put_barrier, "
            "remove_barrier, put_building, remove_building, undo, redo, restart, run, pause, step, set_speed",
            shown(json(*name)))};
    }
    if (!done) return done.error();
    return edit;
}

}  // namespace talus::twin
