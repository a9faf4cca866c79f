#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "session/session.hpp"

namespace talus::session {

/// An answer as HTTP has them.
struct PageAnswer {
    int status = 200;
    std::string type = "application/json";
    Bytes body;
};

/// The requests of a page that a session answers by itself, without a server: see docs/web-engine.md. What needs a
/// machine is not there, and says so.
class PageApi {
  public:
    /// A picture of the ground, where there is one.
    struct Picture {
        std::string type;
        Bytes bytes;
    };
    /// `session` must live as long as this.
    PageApi(Session& session, const scene::Scene& scene, std::optional<Picture> orthophoto)
        : session_(session), scene_(scene), orthophoto_(std::move(orthophoto)) {}

    /// `target`: path and query; `person`: the id of who asks. A change is made before this returns.
    [[nodiscard]] PageAnswer answer(const std::string& method, std::string_view target, std::string_view body,
                                    const std::string& person, const Now& now);

  private:
    [[nodiscard]] PageAnswer get(std::string_view path, const Arguments& query, const Now& now);
    [[nodiscard]] PageAnswer files(const std::string& scenario, const std::string& name);
    [[nodiscard]] PageAnswer terrain(const Arguments& query);
    [[nodiscard]] PageAnswer change(const std::string& method, std::string_view path, const nlohmann::json& body,
                                    const std::string& person, const Now& now);
    [[nodiscard]] PageAnswer control(const nlohmann::json& body, const std::string& person, const Now& now);

    Session& session_;
    const scene::Scene& scene_;
    std::optional<Picture> orthophoto_;
    std::vector<twin::RunFile> files_;  // of a run when its list was last asked for, so that all are of one moment
    std::string files_of_;              // its scenario; empty: they were asked for without a list
    std::map<int, Bytes> terrain_;      // encoded, by thinning factor: there are a few
};

}  // namespace talus::session
