// Observations, triggers and alarms.
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"

namespace talus::twin {

using nlohmann::json;

json Tables::body(const Body& entry) {
    return {{"section", entry.section}, {"name", entry.name()}, {"values", table_values_json(entry)}};
}

Status Tables::read_as(TableKind kind, const json& file, Body& entry) {
    TALUS_TRY(check_keys(file, {"section", "name", "values"}));
    TALUS_ASSIGN(entry, read_table_entry(file, kind));
    return check_table_shape(entry);
}

Status Tables::put_as(TableKind kind, const Put<Entry>& put, Body& entry) {
    const json& given = put.given;
    TALUS_TRY(check_keys(given, {"section", "values"}));
    json wanted = {{"section", sections_of(kind).front()}, {"values", json::object()}};
    const bool several = sections_of(kind).size() > 1;
    if (put.existing != nullptr) wanted["section"] = entry.section;
    if (put.existing == nullptr && several) wanted["section"] = nullptr;
    if (given.contains("section")) {
        if (put.existing != nullptr && given["section"] != wanted["section"]) {
            return Error{fmt::format("section = {}: it stays {}", shown(given["section"]), shown(wanted["section"]))};
        }
        wanted["section"] = given["section"];
    }
    if (put.existing == nullptr) {
        TALUS_ASSIGN(entry, read_table_entry(wanted, kind));
        const bool named = params::find_section(entry.section)->find("name") != nullptr;
        if (named) entry.values["name"] = put.name;
    }
    TALUS_TRY(read_table_values(given.value("values", json::object()), entry));
    std::vector<TableEntry> others;
    for (const TableSetup& other : put.setup.tables(kind)) {
        if (&other != put.existing) others.push_back(*other.body);
    }
    return check_table_entry(entry, kind, others, put.setup, put.context.scene, put.context.particle_spacing);
}

}  // namespace talus::twin
