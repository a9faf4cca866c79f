#include "serve/request_checks.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace talus::serve {

std::optional<Response> refuse_keys(const Arguments& query, const std::vector<std::string>& known) {
    for (const auto& [key, value] : query) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        return error_response(
            400, fmt::format("{} is no key of this address; {}", key.substr(0, 40),
                             known.empty() ? "it has none" : fmt::format("it has {}", fmt::join(known, ", "))));
    }
    return {};
}

Response refuse_role(Role role, Role needs, bool with_token) {
    if (role == Role::nobody && needs == Role::trigger) {
        return error_response(401,
                              fmt::format("{}; header \"Authorization: Bearer TOKEN\" needs the token of triggers, "
                                          "from the file of --trigger-token-file",
                                          with_token ? "the token is wrong" : "no token is given"));
    }
    if (role == Role::nobody && with_token) {
        return error_response(401, "the token is wrong; the server printed the right ones in its links");
    }
    if (role == Role::nobody) {
        return error_response(
            401, "a token is needed, as header \"Authorization: Bearer TOKEN\"; the server printed it in its links");
    }
    if (role == Role::trigger) return error_response(403, "a trigger's token is for POST /api/trigger alone");
    if (needs == Role::trigger) return error_response(403, "this needs the token of triggers");
    return error_response(403, "a viewer's token only reads; this needs the token of controllers");
}

}  // namespace talus::serve
