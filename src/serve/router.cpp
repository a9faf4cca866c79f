#include "serve/router.hpp"

#include <optional>

namespace talus::serve {
namespace {

/// Cuts the part before the next slash off `rest`.
std::string_view next_part(std::string_view& rest) {
    const std::size_t slash = rest.find('/');
    const std::string_view part = rest.substr(0, slash);
    rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
    return part;
}

std::optional<Arguments> match(std::string_view pattern, std::string_view path) {
    Arguments parameters;
    if (path.empty() || path.back() == '/') return {};
    while (!pattern.empty() && !path.empty()) {
        const std::string_view wanted = next_part(pattern), given = next_part(path);
        if (wanted.size() > 2 && wanted.front() == '{') {
            parameters.emplace(wanted.substr(1, wanted.size() - 2), given);
        } else if (wanted != given) {
            return {};
        }
    }
    if (!pattern.empty() || !path.empty()) return {};
    return parameters;
}

}  // namespace

Router::Match Router::find(std::string_view method, std::string_view path) const {
    Match result;
    for (const Route& route : routes_) {
        auto parameters = match(route.pattern, path);
        if (!parameters) continue;
        if (route.method == method || (method == "HEAD" && route.method == "GET")) {
            return {&route, std::move(*parameters), {}};
        }
        if (!result.allow.empty()) result.allow += ", ";
        result.allow += route.method;
    }
    return result;
}

}  // namespace talus::serve
