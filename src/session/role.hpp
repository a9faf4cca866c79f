#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace talus::session {

/// Permissions of a token. Each includes those before it, except that a trigger's has its own route and nothing else:
/// see may().
enum class Role { nobody, trigger, viewer, controller };

/// Whether a role suffices where `needs` is asked for.
[[nodiscard]] constexpr bool may(Role role, Role needs) {
    if (role == Role::trigger || needs == Role::trigger) return role == needs || needs == Role::nobody;
    return role >= needs;
}

/// "viewer", "controller", "trigger", "nobody".
[[nodiscard]] constexpr const char* role_name(Role role) {
    switch (role) {
        case Role::viewer:
            return "viewer";
        case Role::controller:
            return "controller";
        case Role::trigger:
            return "trigger";
        case Role::nobody:
            break;
    }
    return "nobody";
}

/// What goes with a request, by key.
using Arguments = std::map<std::string, std::string, std::less<>>;
/// A text or a frame that many receive.
using Bytes = std::shared_ptr<const std::string>;

}  // namespace talus::session
