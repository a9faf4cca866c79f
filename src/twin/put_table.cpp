// Observations, triggers and alarms.
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/put.hpp"

namespace talus::twin {

using nlohmann::json;

Result<TableEntry> read_table_action(const json& action, const ActionContext& context, const Setup& setup,
                                     TableKind kind, const TableSetup* existing, const std::string& name) {
    TALUS_TRY(check_keys(action, {"action", "id", "section", "values"}));
    json given = {{"section", sections_of(kind).front()}, {"values", json::object()}};
    const bool several = sections_of(kind).size() > 1;
    if (existing != nullptr) given["section"] = existing->body->section;
    if (existing == nullptr && several && !action.contains("section")) given["section"] = nullptr;
    if (action.contains("section")) {
        if (existing != nullptr && action["section"] != given["section"]) {
            return Error{fmt::format("section = {}: it stays {}", shown(action["section"]), shown(given["section"]))};
        }
        given["section"] = action["section"];
    }
    TALUS_ASSIGN(TableEntry entry, read_table_entry(given, kind));
    if (existing != nullptr) entry = *existing->body;
    const bool named = params::find_section(entry.section)->find("name") != nullptr;
    if (existing == nullptr && named) entry.values["name"] = name;
    TALUS_TRY(read_table_values(action.value("values", json::object()), entry));
    std::vector<TableEntry> others;
    for (const TableSetup& other : setup.tables(kind)) {
        if (&other != existing) others.push_back(*other.body);
    }
    TALUS_TRY(check_table_entry(entry, kind, others, setup, context.scene, context.particle_spacing));
    return entry;
}

}  // namespace talus::twin
