#pragma once

#include <string>
#include <string_view>

#include "core/result.hpp"

namespace talus::session {

/// 128 bits from the operating system, as 32 hexadecimal digits. Error: it gave none.
[[nodiscard]] Result<std::string> random_token();

/// Compares every byte, so that the time does not reveal where the first difference is. An empty secret is no one's.
[[nodiscard]] bool same_secret(std::string_view given, std::string_view secret);

}  // namespace talus::session
