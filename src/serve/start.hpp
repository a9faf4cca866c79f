#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "serve/drafts.hpp"
#include "serve/executor.hpp"
#include "serve/job_forms.hpp"
#include "serve/jobs.hpp"
#include "serve/library.hpp"
#include "serve/open_session.hpp"
#include "serve/server.hpp"
#include "serve/session_file.hpp"

namespace talus::serve {

/// The start page: what can be opened, and the opening of it, in place of the session that is open. Everything but
/// close() is for the server's thread; loading and replaying happen on lanes.
class Start {
  public:
    /// What the server has for it; the functions are for the server's thread.
    struct Host {
        Thread thread;
        Executor& executor;
        std::function<OpenSessionPtr()> open;      ///< the session that is open; none
        std::function<void(OpenSessionPtr)> take;  ///< this one is open from now on
    };
    Start(StartSettings settings, ServerOptions options, Host host);
    ~Start();
    Start(const Start&) = delete;
    Start& operator=(const Start&) = delete;
    void close();

    /// As `GET /api/start`.
    void describe(Role role, const Respond& respond);
    /// Opens `{"scene": ID}`, `{"session": ID}` or `{"ensemble": ID}`, a finished one on its scene; with a session
    /// open, `"replace": true` is needed, and that nobody else is in control of it.
    void open(const Request& request, const Respond& respond);
    /// A scene file or a saved session, named by the user who started the program.
    void open_file(const std::filesystem::path& file);
    void cancel(const Respond& respond);
    /// Takes a scene out of the recent ones.
    void forget(const std::string& id, const Respond& respond);
    /// Saves the open session, or a file of one, as `{"name": ..., "file": ...}` says.
    void save(const Request& request, const Respond& respond);
    void remove_saved(const std::string& id, const Respond& respond);
    /// Deletes a scene that was made on this page, with its files.
    void remove_scene(const std::string& id, const Respond& respond);
    /// A scene with all its files as an archive.
    void download(const std::string& id, const Respond& respond);
    void quit(const Respond& respond);
    /// Starts a job as the body of `POST /api/jobs` says.
    void add_job(const Request& request, const Respond& respond);
    /// Calls `ask` with the scene of this id, or answers that there is none.
    void with_scene(const std::string& id, const Respond& respond, std::function<void(const KnownScene&)> ask);
    [[nodiscard]] Jobs& jobs() { return *jobs_; }
    [[nodiscard]] JobForms& job_forms() { return *job_forms_; }
    /// New scenes.
    [[nodiscard]] Drafts& drafts() { return *drafts_; }

  private:
    /// What to open.
    struct Wanted {
        std::optional<KnownScene> scene;                    ///< either this
        std::filesystem::path session;                      ///< or this file
        bool any_scene = false;                             ///< the session's scene need not be known
        std::string what;                                   ///< for people
        std::vector<std::filesystem::path> ensembles = {};  ///< shown on the scene
    };
    struct Loaded {
        std::shared_ptr<const scene::Scene> scene;
        ServerOptions options;
        std::vector<OpeningScenario> scenarios;
        std::vector<std::string> notes;
        std::vector<Overlay> overlays;
        std::vector<TileAddress> tiles;
    };
    /// What one of the three names is.
    [[nodiscard]] Result<Wanted> find(const std::string& scene, const std::string& session,
                                      const std::string& ensemble) const;
    /// On the lane of files: what save() is asked.
    void save_wanted(const std::string& body, const Respond& respond);
    void save_open(const std::string& name, const Respond& respond);
    /// On the lane of files: the text of a session.
    void keep(const std::string& name, const std::string& session, const Respond& respond) const;
    void begin(Wanted wanted, const Respond& respond);
    void work(const Wanted& wanted);
    [[nodiscard]] Result<Loaded> load(const Wanted& wanted);
    [[nodiscard]] Result<Loaded> load_scene(const KnownScene& known, const std::vector<std::string>& overrides);
    [[nodiscard]] Result<KnownScene> scene_of(const SessionFile& file, bool any) const;
    [[nodiscard]] bool say(const std::string& what, double share);
    void put_in_place();
    void end(const std::string& error);

    const StartSettings settings_;
    const ServerOptions options_;
    const Host host_;
    const Library library_;
    std::atomic<bool> stop_{false};
    std::mutex mutex_;  // guards the following
    struct {
        bool busy = false;
        std::string what, error;  ///< what is being opened; why the last one could not be
        double share = 0;
        int count = 0;                   ///< sessions opened so far
        std::vector<std::string> notes;  ///< about the one that is open
    } state_;
    OpenSessionPtr made_;  // on its way to its place
    int folders_ = 0;      // of sessions, for their names; used by the opener only
    bool closed_ = false;
    Lane files_{host_.executor, "start"};
    std::unique_ptr<Drafts> drafts_;
    std::unique_ptr<Jobs> jobs_;
    std::unique_ptr<JobForms> job_forms_ = std::make_unique<JobForms>(host_.executor);
    Lane opener_{host_.executor, "opener"};
};

}  // namespace talus::serve
