#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "run/variants.hpp"
#include "serve/executor.hpp"
#include "serve/sent_files.hpp"
#include "serve/session.hpp"

namespace talus::serve {

/// The name of the session in one page among them.
inline constexpr const char* twin_html = "twin.html";

/// The result files of the runs so far, written on request and kept until the run has continued. Meanwhile
/// steps continue: the run is written elsewhere as it was at the request.
class Exports {
  public:
    /// `folder`: an existing one to write into; it is not removed.
    /// `source`: loads the session's scene again; no file: there is no scene.zip.
    Exports(Session& session, std::filesystem::path folder, run::SceneSource source);
    ~Exports();
    /// Ends its lane; pending requests are not answered. The session must have been closed before.
    void close();
    Exports(const Exports&) = delete;
    Exports& operator=(const Exports&) = delete;

    /// Who answers with the open session as one page (twin_page.hpp); without it there is none. Once, before requests.
    void offer_twin(std::function<void(const Respond&)> twin) { twin_ = std::move(twin); }

    /// Answers `{"files": [...]}` for a scenario.
    void list(const std::string& scenario, const Respond& respond);
    /// Answers with a file. Errors: none of that name, disk full.
    void file(const std::string& scenario, const std::string& name, const Respond& respond);

  private:
    struct Snapshot;
    using SnapshotPtr = std::shared_ptr<Snapshot>;
    [[nodiscard]] bool is_current(int index, const twin::Scenario& scenario) const;

    void scene_archive(const twin::Scenario& scenario, const Respond& respond);

    Session& session_;
    std::filesystem::path folder_;
    run::SceneSource source_;
    std::array<SnapshotPtr, Scenarios::max_count> taken_;  // the latest; used by the loop's thread only
    std::function<void(const Respond&)> twin_;
    std::uint64_t count_ = 0;  // of folders, for their names; likewise
    SentFiles sent_;
    std::weak_ptr<const std::string> archive_sent_;  // a scene.zip while it is being sent; used by the writer only
    std::string archived_;                           // the scene file in it
    Lane writer_;
};

}  // namespace talus::serve
