#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "messages/messages.hpp"
#include "params/fields.hpp"
#include "params/spec.hpp"
#include "scene/scene.hpp"

/// Entries of the scene file's tables that no step of a run knows: field observations, triggers and alarms. Their keys,
/// ranges and rules are those of the field table and of the scene file's reader.
namespace talus::twin {

struct Setup;

enum class TableKind { observation, trigger, alarm };

/// The sections of a kind that people may add to, in the order of the scene file. Those that name a file are not among
/// them.
[[nodiscard]] const std::vector<std::string>& sections_of(TableKind kind);

struct TableEntry {
    std::string section;                                   ///< "run_up"
    std::map<std::string, params::ParameterValue> values;  ///< by key; without those that have none

    /// The name, or what a damage names.
    [[nodiscard]] std::string name() const;
};

/// Those of a scene.
[[nodiscard]] std::vector<TableEntry> entries_of(const params::SceneSpec& spec, TableKind kind);

/// These in place of all entries of that kind.
void put_entries(params::SceneSpec& spec, TableKind kind, const std::vector<TableEntry>& entries);

/// In all values, with the default of what is not given.
[[nodiscard]] bool operator==(const TableEntry& a, const TableEntry& b);

/// Values by key; null: none.
[[nodiscard]] nlohmann::json table_values_json(const TableEntry& entry);

/// Changes values: null takes one away. Errors name key, value and what is allowed; nothing is known of a scene.
[[nodiscard]] Status read_table_values(const nlohmann::json& values, TableEntry& entry);

/// As a setup file has it: section and values. Errors: no section of that kind; as read_table_values.
[[nodiscard]] Result<TableEntry> read_table_entry(const nlohmann::json& file, TableKind kind);

/// What of check_table_entry() needs neither a scene nor other entries: required keys, and rules between keys.
[[nodiscard]] Status check_table_shape(const TableEntry& entry);

/// As the reader of a scene file: required keys, rules, places, names. `others`: the rest of that kind. Structures of
/// an alarm are those of the setup; a trigger's release or inflow and a damaged building are of the scene file, from
/// which their runs start.
[[nodiscard]] Status check_table_entry(const TableEntry& entry, TableKind kind, const std::vector<TableEntry>& others,
                                       const Setup& setup, const scene::Scene& scene, double particle_spacing);

/// What a form needs to know of each section: `TableSection[]` of docs/protocol.md.
[[nodiscard]] std::vector<messages::TableSection> table_sections();

}  // namespace talus::twin
