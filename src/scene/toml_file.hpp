#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <toml++/toml.h>

#include "core/result.hpp"
#include "params/fields.hpp"

/// Shared by all readers of TOML files.
namespace talus::scene {

/// Reads a whole file; messages call it `what` ("scene"). Errors: missing, a folder, too large, not UTF-8, not TOML
/// (with the line).
[[nodiscard]] Result<toml::table> read_toml_file(const std::filesystem::path& file, const std::string& what);

/// The node as written, in one line, cut where it is long.
[[nodiscard]] std::string toml_text_of(const toml::node& node);

/// The node as a value of the parameter's kind; empty if it is of another kind.
[[nodiscard]] std::optional<params::ParameterValue> to_parameter_value(const toml::node& node,
                                                                       params::ParameterKind kind);

}  // namespace talus::scene
