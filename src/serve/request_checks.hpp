#pragma once

#include <optional>
#include <string>
#include <vector>

#include "serve/message.hpp"
#include "session/role.hpp"

/// The answers to requests that are refused by what they say of themselves.
namespace talus::serve {

/// A query with a key that its address has not.
[[nodiscard]] std::optional<Response> refuse_keys(const Arguments& query, const std::vector<std::string>& known);

/// A request of somebody who may not make it. `with_token`: it has one, be it a wrong one.
[[nodiscard]] Response refuse_role(Role role, Role needs, bool with_token);

}  // namespace talus::serve
