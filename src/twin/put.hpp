#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "scene/bed_layer.hpp"
#include "scene/zone.hpp"
#include "terrain/buildings.hpp"
#include "terrain/gauge.hpp"
#include "terrain/inflow.hpp"
#include "terrain/release.hpp"
#include "twin/action.hpp"
#include "twin/setup.hpp"
#include "twin/table_entry.hpp"

/// The put actions of docs/protocol.md. Each returns `existing` with the values of the action, or a new one if that is
/// nullptr, with this name. Errors name key, value and what is allowed.
namespace talus::twin {

/// `setup`: with the other releases.
[[nodiscard]] Result<terrain::Release> read_release(const nlohmann::json& action, const ActionContext& context,
                                                    const Setup& setup, const ReleaseSetup* existing,
                                                    const std::string& name);

[[nodiscard]] Result<terrain::Building> read_barrier(const nlohmann::json& action, const ActionContext& context,
                                                     const terrain::Building* existing, const std::string& name);

[[nodiscard]] Result<terrain::Building> read_building(const nlohmann::json& action, const ActionContext& context,
                                                      const terrain::Building* existing, const std::string& name);

[[nodiscard]] Result<scene::Zone> read_zone(const nlohmann::json& action, const ActionContext& context,
                                            const scene::Zone* existing, const std::string& name);

[[nodiscard]] Result<scene::BedLayer> read_bed(const nlohmann::json& action, const ActionContext& context,
                                               const scene::BedLayer* existing, const std::string& name);

/// `setup`: with all sources of debris, whose particles must not exceed the limit.
[[nodiscard]] Result<terrain::Inflow> read_inflow(const nlohmann::json& action, const ActionContext& context,
                                                  const Setup& setup, const InflowSetup* existing,
                                                  const std::string& name);

/// At a place or at a chainage. Errors: neither or both, beside the terrain or the flow path, the name of another.
[[nodiscard]] Result<terrain::Gauge> read_gauge_place(const nlohmann::json& action, const ActionContext& context,
                                                      const Setup& setup, const GaugeSetup* existing,
                                                      const std::string& name);

/// Errors: without a text, or beside the terrain.
[[nodiscard]] Result<Note> read_note(const nlohmann::json& action, const ActionContext& context, const Note* existing,
                                     const std::string& name);

/// An entry of `[[section]]`: the values of the action in place of those that are there. Errors: no such section; as
/// the reader of a scene file.
[[nodiscard]] Result<TableEntry> read_table_action(const nlohmann::json& action, const ActionContext& context,
                                                   const Setup& setup, TableKind kind, const TableSetup* existing,
                                                   const std::string& name);

/// Particles of all sources of debris, with this inflow in place of `existing`; `spacing` in m.
[[nodiscard]] double particles_in_all(const Setup& setup, const InflowSetup* existing, const terrain::Inflow& inflow,
                                      double spacing);

}  // namespace talus::twin
