#pragma once

#include <string>
#include <string_view>

#include "core/result.hpp"
#include "session/role.hpp"

namespace talus::session {

struct Target {
    std::string path;  ///< decoded
    Arguments query;   ///< decoded; the last value of a repeated key
};

/// Parses the target of a request. Errors: not a path, a bad percent sequence, control characters.
[[nodiscard]] Result<Target> parse_target(std::string_view text);

}  // namespace talus::session
