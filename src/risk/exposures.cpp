#include "risk/exposures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/quantity.hpp"
#include "core/try.hpp"
#include "geo/mesh.hpp"
#include "geo/vector.hpp"
#include "params/fields.hpp"
#include "scene/attributes.hpp"
#include "scene/parse.hpp"

namespace talus::risk {
namespace {

using params::ExposureSpec;

constexpr double day = 86400;  // s

std::string at(const scene::Scene& scene, std::size_t exposure, const char* key) {
    return fmt::format("{}: exposure[{}].{}", scene.file.string(), exposure, key);
}

/// The attributes of the layer of buildings by the name of the building.
using Attributes = std::map<std::string, std::map<std::string, geo::Attribute>>;

Result<Attributes> read_attributes(const scene::Scene& scene) {
    const params::BuildingsSpec& spec = scene.spec.buildings;
    if (geo::is_mesh_file(spec.file)) {
        return Error{
            fmt::format("{}: an exposure's attributes are read from footprints, not from a mesh; give value, "
                        "persons and presence instead",
                        spec.file)};
    }
    TALUS_ASSIGN(const geo::PolygonLayer layer, geo::read_polygons(spec.file, spec.layer, scene.crs));
    Attributes all;
    for (std::size_t k = 0; k < layer.features.size(); ++k) {
        const auto& own = layer.features[k].attributes;
        const auto name = own.find(spec.name_attribute);
        std::string text;
        if (name != own.end()) {
            if (const auto* word = std::get_if<std::string>(&name->second)) text = *word;
            if (const auto* number = std::get_if<double>(&name->second)) text = fmt::format("{}", *number);
        }
        all[text.empty() ? fmt::format("building {}", k + 1) : text] = own;
    }
    return all;
}

class Finder {
  public:
    explicit Finder(const scene::Scene& scene) : scene_(scene) {}

    Result<Exposures> find() {
        TALUS_ASSIGN(found_.curves, all_curves(scene_.spec.risk.curves));
        const std::size_t own = scene_.buildings.size() - scene_.barrier_sections.size();
        for (std::size_t b = 0; b < own; ++b) {
            ExposedBuilding building;
            building.name = scene_.buildings[b].name;
            building.footprint = scene_.buildings[b].footprint;
            found_.buildings.push_back(std::move(building));
        }
        for (std::size_t k = 0; k < scene_.spec.exposures.size(); ++k) {
            const bool road = scene_.spec.exposures[k].kind == params::ExposureKind::road;
            TALUS_TRY(road ? add_road(k) : add_buildings(k));
        }
        if (const std::string& name = scene_.spec.risk.map_death_curve; !name.empty()) {
            const auto curve = find_curve(found_.curves, name, Effect::death);
            if (!curve) return Error{scene_.file.string() + ": risk.map_death_curve " + curve.error().message};
            found_.map_death = *curve;
        }
        return std::move(found_);
    }

  private:
    Result<const Curve*> curve_of(std::size_t k, const char* key, const std::string& name, Effect effect) {
        if (name.empty()) return static_cast<const Curve*>(nullptr);
        const auto curve = find_curve(found_.curves, name, effect);
        if (!curve) return Error{at(scene_, k, key) + " " + curve.error().message};
        return *curve;
    }

    Status add_buildings(std::size_t k) {
        const ExposureSpec& spec = scene_.spec.exposures[k];
        TALUS_ASSIGN(const Curve* const damage, curve_of(k, "damage_curve", spec.damage_curve, Effect::damage));
        TALUS_ASSIGN(const Curve* const death, curve_of(k, "death_curve", spec.death_curve, Effect::death));
        std::vector<std::string> names = spec.buildings;
        if (names.empty()) {
            for (const ExposedBuilding& building : found_.buildings) names.push_back(building.name);
        }
        if (names.empty()) return Error{at(scene_, k, "buildings") + ": the scene has no buildings"};
        for (const std::string& name : names) {
            TALUS_ASSIGN(ExposedBuilding* const building, take(k, name));
            building->exposure = spec.name;
            building->damage = damage;
            building->death = death;
            const double most = std::numeric_limits<double>::infinity();
            TALUS_ASSIGN(building->value, number(k, name, "value", spec.value, spec.value_attribute, most));
            TALUS_ASSIGN(building->persons, number(k, name, "persons", spec.persons, spec.persons_attribute, 1e5));
            TALUS_ASSIGN(building->presence, number(k, name, "presence", spec.presence, spec.presence_attribute, 1));
        }
        return {};
    }

    /// The building of that name, which no other exposure has.
    Result<ExposedBuilding*> take(std::size_t k, const std::string& name) {
        ExposedBuilding* found = nullptr;
        for (ExposedBuilding& building : found_.buildings) {
            if (building.name != name) continue;
            if (found != nullptr) {
                return Error{
                    fmt::format("{}: two buildings are called \"{}\"; exposed buildings need names of their own "
                                "(buildings.name_attribute)",
                                at(scene_, k, "buildings"), scene::one_line(name, 80))};
            }
            found = &building;
        }
        if (found == nullptr) {
            std::vector<std::string> names;
            for (const ExposedBuilding& building : found_.buildings) names.push_back(building.name);
            return Error{fmt::format("{}: there is no building \"{}\"; buildings: {}", at(scene_, k, "buildings"),
                                     scene::one_line(name, 80),
                                     scene::one_line(fmt::format("{}", fmt::join(names, ", ")), 300))};
        }
        if (!found->exposure.empty()) {
            return Error{fmt::format("{}: building \"{}\" is in the exposure \"{}\" already",
                                     at(scene_, k, "buildings"), scene::one_line(name, 80), found->exposure)};
        }
        return found;
    }

    /// The value of a key, or of the attribute that has it for this building.
    Result<double> number(std::size_t k, const std::string& building, const char* key,
                          const std::optional<double>& given, const std::string& attribute, double most) {
        if (attribute.empty()) return given.value_or(0);
        const std::string place = at(scene_, k, (std::string(key) + "_attribute").c_str());
        if (!attributes_) {
            auto read = read_attributes(scene_);
            if (!read) return Error{place + ": " + read.error().message};
            attributes_ = *std::move(read);
        }
        const auto& own = (*attributes_)[building];
        const auto found = own.find(attribute);
        if (found == own.end()) {
            std::vector<std::string> names;
            for (const auto& [name, value] : own) names.push_back(name);
            return Error{fmt::format("{} = \"{}\": {} has no such attribute; attributes: {}", place, attribute,
                                     scene_.spec.buildings.file, fmt::join(names, ", "))};
        }
        const auto value = scene::number_of(found->second, Dimension::none);
        if (!value || !*value || !(**value >= 0) || !(**value <= most)) {
            return Error{fmt::format("{}: building \"{}\" has {} = {}; it must be a number {}", place,
                                     scene::one_line(building, 80), attribute, scene::attribute_text(found->second),
                                     std::isfinite(most) ? fmt::format("from 0 to {}", most) : "of at least 0")};
        }
        return **value;
    }

    Status add_road(std::size_t k) {
        const ExposureSpec& spec = scene_.spec.exposures[k];
        ExposedRoad road;
        road.name = spec.name;
        TALUS_ASSIGN(road.death, curve_of(k, "death_curve", spec.death_curve, Effect::death));
        road.line = spec.line;
        const char* key = spec.file.empty() ? "line_m" : "file";
        if (!spec.file.empty()) {
            auto line = geo::read_line(spec.file, spec.layer, scene_.crs);
            if (!line) return Error{at(scene_, k, key) + ": " + line.error().message};
            road.line = std::move(line->points);
        }
        double length = 0;
        for (std::size_t i = 1; i < road.line.size(); ++i) {
            length += std::hypot(road.line[i].x - road.line[i - 1].x, road.line[i].y - road.line[i - 1].y);
        }
        if (!(length > 0)) return Error{at(scene_, k, key) + ": the road has no length"};
        place_along(scene_.terrain.cell() / 2, length, road);
        const Extent extent = scene_.terrain.elevation().geometry.extent();
        const bool reached = std::any_of(road.places.begin(), road.places.end(), [&](const PlanPoint& p) {
            return p.x >= extent.x_min && p.x <= extent.x_max && p.y >= extent.y_min && p.y <= extent.y_max;
        });
        if (!reached) return Error{at(scene_, k, key) + ": the road lies outside the terrain"};
        road.persons_per_metre = *spec.vehicles_per_day * *spec.persons_per_vehicle / (day * *spec.speed);
        road.has_busiest = spec.trips_per_day.has_value();
        road.busiest_presence = spec.trips_per_day.value_or(0) / (day * *spec.speed);
        found_.roads.push_back(std::move(road));
        return {};
    }

    /// Places in the middle of equal parts of the line.
    static void place_along(double widest, double length, ExposedRoad& road) {
        const double count = std::ceil(length / widest);
        road.step = length / count;
        double passed = 0;
        for (std::size_t i = 1; i < road.line.size(); ++i) {
            const PlanPoint &a = road.line[i - 1], &b = road.line[i];
            const double part = std::hypot(b.x - a.x, b.y - a.y);
            while (static_cast<double>(road.places.size()) < count) {
                const double share = ((static_cast<double>(road.places.size()) + 0.5) * road.step - passed) / part;
                if (!(share <= 1)) break;
                road.places.push_back({std::lerp(a.x, b.x, share), std::lerp(a.y, b.y, share)});
            }
            passed += part;
        }
    }

    const scene::Scene& scene_;
    Exposures found_;
    std::optional<Attributes> attributes_;
};

}  // namespace

bool Exposures::any_building() const {
    return std::any_of(buildings.begin(), buildings.end(),
                       [](const ExposedBuilding& building) { return !building.exposure.empty(); });
}

Result<Exposures> find_exposures(const scene::Scene& scene) {
    return Finder(scene).find();
}

}  // namespace talus::risk
