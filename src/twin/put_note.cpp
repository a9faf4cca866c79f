#include <cmath>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/put.hpp"

namespace talus::twin {

Result<Note> read_note(const nlohmann::json& action, const ActionContext& context, const Note* existing,
                       const std::string& name) {
    TALUS_TRY(check_keys(action, {"action", "id", "name", "x_m", "y_m"}));
    if (existing == nullptr && !action.contains("name")) return Error{"name: missing; it is what the note says"};
    Note note;
    if (existing != nullptr) note = *existing;
    note.name = name;
    TALUS_ASSIGN(const auto x, read_number(action, "x_m", {}, "m"));
    TALUS_ASSIGN(const auto y, read_number(action, "y_m", {}, "m"));
    if (x.has_value() != y.has_value() || (existing == nullptr && !x)) {
        return Error{fmt::format("{}: missing; the place of a note is x_m and y_m", x ? "y_m" : "x_m")};
    }
    if (x) note.at = {*x, *y};
    if (std::isnan(context.scene.terrain.elevation_at(note.at))) {
        return Error{fmt::format("x_m = {:.10g}, y_m = {:.10g}: not on the terrain", note.at.x, note.at.y)};
    }
    return note;
}

}  // namespace talus::twin
