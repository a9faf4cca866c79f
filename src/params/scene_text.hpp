#pragma once

#include <string>
#include <vector>

#include "params/fields.hpp"

/// Texts generated from the field table.
namespace talus::params {

/// A commented scene file. Values that differ from the default are set; every other key is there as a comment with its
/// default ("none" where there is none), unit, allowed range and help. `header`: comment lines at the top, without the
/// "# ".
[[nodiscard]] std::string write_scene(const SceneSpec& spec, const std::string& header = "");

/// The same with no other comments than those of the keys that matter first.
[[nodiscard]] std::string write_short_scene(const SceneSpec& spec, const std::string& header = "");

/// The twenty keys of a new scene, as "section.key".
[[nodiscard]] const std::vector<std::string>& first_keys();

/// docs/scene-reference.md.
[[nodiscard]] std::string scene_reference_markdown();

/// web/src/protocol/schema.ts: live parameters, as types and as the fields of forms.
[[nodiscard]] std::string scene_typescript();

/// The reference for a terminal.
[[nodiscard]] std::string scene_reference_text();

}  // namespace talus::params
