#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "serve/draft.hpp"
#include "serve/executor.hpp"
#include "serve/message.hpp"

namespace talus::serve {

/// The new scene that is being made on the start page; beginning another one discards it, so that uploads never take
/// more than one draft's bytes. For the server's thread; files are written and read on a lane.
class Drafts {
  public:
    /// `library`: the start page's folder; drafts are below `drafts`, what a program that died left there is removed.
    /// `reader`: of what is uploaded.
    Drafts(Executor& executor, std::filesystem::path library, UploadLimits limits, std::filesystem::path temporary,
           geo::ForeignReader reader);
    ~Drafts();
    Drafts(const Drafts&) = delete;
    Drafts& operator=(const Drafts&) = delete;

    [[nodiscard]] const UploadLimits& limits() const { return limits_; }
    void begin(const Respond& respond);
    void describe(const std::string& id, const Respond& respond);
    void discard(const std::string& id, const Respond& respond);
    /// A file that comes piece by piece. Until it is whole it is `upload-N.part` in the draft's folder.
    [[nodiscard]] std::shared_ptr<Intake> intake(const Request& request);
    void remove(const std::string& id, const std::string& role, const Respond& respond);
    void mend(const Request& request, const Respond& respond);
    /// The terrain as a grid for the page, thinned.
    void relief(const std::string& id, const Respond& respond);
    /// Checks what the body says, and makes a scene of it unless it says `"check": true`.
    void make(const Request& request, const Respond& respond);
    /// A scene file with all its files, as an archive. `builtin`: the built-in one in its place.
    void pack(const std::filesystem::path& scene, bool builtin, const std::string& name, const Respond& respond);

  private:
    class Taking;
    using Stop = std::shared_ptr<std::atomic<bool>>;
    /// Ends the reading of what was uploaded, now or when its turn comes: a file may be made to be read without end.
    /// Empty: of all roles.
    void stop_reading(const std::string& role = "");
    [[nodiscard]] Stop begin_reading(const std::string& role);
    /// The draft of this id; answers otherwise. On the lane.
    [[nodiscard]] Draft* find(const std::string& id, const Respond& respond);
    void remove_leftovers() const;

    const std::filesystem::path library_, temporary_;
    const UploadLimits limits_;
    const geo::ForeignReader reader_;
    std::mutex mutex_;  // guards the following
    std::vector<std::pair<std::string, std::weak_ptr<std::atomic<bool>>>> readings_;
    std::string id_;  // used on the lane only, as the following
    std::unique_ptr<Draft> draft_;
    int uploads_ = 0;
    Lane lane_;
};

}  // namespace talus::serve
