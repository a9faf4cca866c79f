#pragma once

#include <string_view>

#include "core/result.hpp"
#include "serve/message.hpp"

namespace talus::serve {

struct Target {
    std::string path;  ///< decoded
    Arguments query;   ///< decoded; the last value of a repeated key
};

/// Parses the target of a request. Errors: not a path, a bad percent sequence, control characters.
[[nodiscard]] Result<Target> parse_target(std::string_view text);

}  // namespace talus::serve
