#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "serve/message.hpp"

namespace talus::serve {

using Handler = std::function<void(const Request&, const Respond&)>;

struct Route {
    std::string method;
    std::string pattern;                  ///< "/api/scenarios/{s}/state"
    Role needs = Role::viewer;            ///< nobody: no token required
    Handler handler;                      ///< called on the server's thread; must not block
    std::vector<std::string> query = {};  ///< keys that the query of a request may have
    /// Takes the body in place of `handler`, which then answers requests without one.
    std::function<std::shared_ptr<Intake>(const Request&)> intake = {};
    std::uint64_t largest_body = 0;  ///< bytes; 0: as usual
};

/// The table of routes.
class Router {
  public:
    void add(Route route) { routes_.push_back(std::move(route)); }
    [[nodiscard]] const std::vector<Route>& routes() const { return routes_; }

    struct Match {
        const Route* route = nullptr;
        Arguments parameters;
        std::string allow;  ///< where there is no route: the methods that the path has; empty: no such path
    };
    /// HEAD finds the same as GET.
    [[nodiscard]] Match find(std::string_view method, std::string_view path) const;

  private:
    std::vector<Route> routes_;
};

}  // namespace talus::serve
