#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "messages/messages.hpp"
#include "serve/executor.hpp"
#include "serve/long_task.hpp"
#include "serve/sent_files.hpp"
#include "serve/session.hpp"
#include "twin/recorded_flow.hpp"

namespace talus::serve {

/// The moving flow of a scenario as files for other programs, from its recording: one at a time for the session, at
/// lower priority while the steps continue. Its files are kept until the next one. Functions may be called from any
/// thread.
class FlowExports {
  public:
    /// `folder`: an existing one to write into; it is not removed.
    FlowExports(Session& session, std::filesystem::path folder);
    ~FlowExports();
    /// Ends its lane and deletes its files. The session must have been closed before.
    void close();
    FlowExports(const FlowExports&) = delete;
    FlowExports& operator=(const FlowExports&) = delete;

    /// Answers with what there would be at an interval, s; empty: that of the scene.
    void offer(const std::string& scenario, std::optional<double> interval, const Respond& respond);
    /// Begins one. `body`: WantedFlow of docs/protocol.md.
    void start(const std::string& scenario, const std::string& body, const Respond& respond);
    /// As `GET /api/flow`.
    [[nodiscard]] messages::FlowExport describe() const;
    /// Ends the one that is being made, or deletes the files of the last one.
    void cancel();
    /// Answers with a file of the last one. Errors: none of that name.
    void file(const std::string& name, const Respond& respond) const;

  private:
    struct Job : LongTask {
        std::string scenario;
        double share = 0;
        std::vector<std::string> files;  ///< names, in the order of their formats
        std::filesystem::path folder;
    };
    struct Wanted {
        std::vector<std::string> formats;
        double interval = 0;  ///< s; 0: that of the scene
    };
    [[nodiscard]] static Result<Wanted> read(const std::string& body);
    [[nodiscard]] Response begin(const std::string& scenario, const std::shared_ptr<const twin::RecordedFlow>& flow,
                                 const Wanted& wanted);
    void write(const twin::RecordedFlow& flow, const Wanted& wanted, const Job& job);
    [[nodiscard]] messages::FlowExport describe_now() const;
    void end(Job::State state, std::string message);

    Session& session_;
    std::filesystem::path folder_;
    mutable std::mutex mutex_;  // guards job_ and count_
    Job job_;
    std::uint64_t count_ = 0;  // of folders, for their names
    const std::shared_ptr<SentFiles> sent_ = std::make_shared<SentFiles>();
    Lane writer_;
};

}  // namespace talus::serve
