#pragma once

#include <string>

#include "params/fields.hpp"

/// Texts generated from the field table.
namespace talus::params {

/// A commented scene file. Values that differ from the default are set; every other key is there as a comment with its
/// default, unit, allowed range and help. `header`: comment lines at the top, without the "# ".
[[nodiscard]] std::string write_scene(const SceneSpec& spec, const std::string& header = "");

/// docs/scene-reference.md.
[[nodiscard]] std::string scene_reference_markdown();

/// web/src/protocol/schema.ts: live parameters, as types and as the fields of forms.
[[nodiscard]] std::string scene_typescript();

/// The reference for a terminal.
[[nodiscard]] std::string scene_reference_text();

}  // namespace talus::params
