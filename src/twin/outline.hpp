#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "core/try.hpp"
#include "scene/known_ground.hpp"
#include "terrain/release.hpp"
#include "terrain/terrain.hpp"
#include "twin/json_keys.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// A change of position by an action: a new outline without courtyards, or a displacement of all parts.
struct Redrawn {
    std::optional<Ring> ring;
    std::optional<PlanPoint> by;
    const char* key = "";  ///< the key of the action at fault
    explicit operator bool() const { return ring || by; }
};

/// `outline`: the key of the ring; `move_m` moves all parts and courtyards, which a single ring cannot describe.
/// Errors: a move of a shape that does not exist yet, or both.
[[nodiscard]] Result<Redrawn> read_redrawn(const nlohmann::json& action, const char* outline, const char* what,
                                           bool exists);
/// Errors also: no ring of a new one.
[[nodiscard]] Result<Redrawn> read_outline(const nlohmann::json& action, const char* outline, const char* what,
                                           bool exists);

/// The polygon, holes and all, shifted in the plane, m.
[[nodiscard]] Polygon moved(Polygon polygon, const PlanPoint& by);

/// Applies the new position to the parts: a new outline replaces them by one, with the other values of the first. A
/// drawn outline must have an area; `whole`: all of it must lie on known ground, otherwise some of it.
template <class Part>
[[nodiscard]] Status redraw(const Redrawn& drawn, const terrain::Terrain& terrain, bool whole,
                            std::vector<Part>& parts) {
    const auto polygon_of = [](Part& part) -> Polygon& {
        if constexpr (std::is_same_v<Part, Polygon>) {
            return part;
        } else {
            return part.polygon;
        }
    };
    if (drawn.ring) {
        Polygon polygon{*drawn.ring, {}};
        TALUS_TRY(scene::check_area(terrain, polygon, drawn.key, whole));
        parts.resize(1);
        polygon_of(parts.front()) = std::move(polygon);
    }
    if (!drawn.by) return {};
    for (Part& part : parts) {
        polygon_of(part) = moved(std::move(polygon_of(part)), *drawn.by);
        TALUS_TRY(scene::check_ground(terrain, polygon_of(part), drawn.key, whole));
    }
    return {};
}

/// Maximum number of points of a drawn outline or line.
inline constexpr std::size_t max_points = 500;

/// "line: missing; a new barrier needs it".
[[nodiscard]] Error missing(const char* key, const char* what);

// Of setup files. Errors name key and value.

[[nodiscard]] Error not_of_a_setup(const char* key, const nlohmann::json& file);
[[nodiscard]] Result<std::string> read_name(const nlohmann::json& file);
/// "polygons": of each the outer ring, then holes.
[[nodiscard]] Result<std::vector<Polygon>> read_polygons(const nlohmann::json& file);

/// "polygons", and under `numbers` a number of each.
template <class Part>
void write_parts(const std::vector<Part>& parts, const char* numbers, double Part::*number, nlohmann::json& file) {
    file["polygons"] = file[numbers] = nlohmann::json::array();
    for (const Part& part : parts) {
        file["polygons"].push_back(to_json(part.polygon));
        file[numbers].push_back(part.*number);
    }
}

template <class Part>
[[nodiscard]] Status read_parts(const nlohmann::json& file, const char* numbers, double Part::*number,
                                std::vector<Part>& parts) {
    TALUS_ASSIGN(auto polygons, read_polygons(file));
    const nlohmann::json values = file.value(numbers, nlohmann::json());
    if (!values.is_array() || values.size() != polygons.size()) return not_of_a_setup(numbers, file);
    parts.assign(polygons.size(), {});
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (!values[k].is_number()) return not_of_a_setup(numbers, file);
        parts[k].polygon = std::move(polygons[k]);
        parts[k].*number = values[k].template get<double>();
    }
    return {};
}

}  // namespace talus::twin
