#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "serve/access.hpp"

namespace talus::cli {

/// The tokens given with --token, for controllers and viewers, or new ones.
[[nodiscard]] Result<serve::Tokens> choose_tokens(const std::vector<std::string>& given);

}  // namespace talus::cli
