#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "messages/messages.hpp"
#include "serve/executor.hpp"
#include "serve/job.hpp"
#include "serve/library.hpp"
#include "serve/message.hpp"

namespace talus::serve {

/// Ensembles, calibrations and validations that were started on the start page. Each is the program's own command in a
/// process of its own, one at a time, at a lower priority; the others wait. A job is kept as `FOLDER/ID.json` and the
/// folder that the command writes, `FOLDER/ID`, until somebody deletes it. Functions may be called from any thread.
class Jobs {
  public:
    static constexpr std::size_t most_waiting = 8, most_kept = 200;

    /// `program`: the one to run; empty: there are no jobs. What a program that died left open is interrupted now.
    Jobs(Executor& executor, std::filesystem::path folder, std::filesystem::path program);
    ~Jobs();
    Jobs(const Jobs&) = delete;
    Jobs& operator=(const Jobs&) = delete;

    /// As `jobs` of `GET /api/start`; nothing: there are none here.
    [[nodiscard]] std::optional<std::vector<messages::Job>> describe() const;
    /// Puts one into the queue and returns its id. `scene`: unless it is a validation. Errors: too many wait or are
    /// kept, disk full.
    [[nodiscard]] Result<std::string> add(const WantedJob& wanted, const std::optional<KnownScene>& scene);
    /// Error: it is not open, there is none of this id.
    [[nodiscard]] Status cancel(const std::string& id);
    /// Lets one that did not end go on where it was. Error: it is open or done.
    [[nodiscard]] Status resume(const std::string& id);
    /// Deletes it with its folder. Error: it is open.
    [[nodiscard]] Status remove(const std::string& id);
    /// The page of its result. Error: there is none of this ticket, which describe() gives.
    [[nodiscard]] Result<std::string> report(const std::string& ticket) const;
    /// A finished ensemble and the scene that it is of. Error: there is none of this id.
    struct Finished {
        std::string scene;
        std::filesystem::path folder;
    };
    [[nodiscard]] Result<Finished> ensemble(const std::string& id) const;

  private:
    struct Entry {
        Job job;
        std::string ticket;  ///< of its report: a link that needs no token
    };
    using EntryPtr = std::shared_ptr<Entry>;
    void load();
    void run(const EntryPtr& entry);
    [[nodiscard]] static std::vector<std::string> words_of(const Job& job);
    // Under the lock:
    [[nodiscard]] Result<EntryPtr> find(const std::string& id) const;
    [[nodiscard]] Status check_room() const;
    [[nodiscard]] Result<std::string> new_id(JobKind kind) const;
    [[nodiscard]] Status keep(const Job& job) const;
    void queue(const EntryPtr& entry);

    const std::filesystem::path folder_, program_;
    std::atomic<bool> closing_{false};
    mutable std::mutex mutex_;  // guards the following
    std::map<std::string, EntryPtr> entries_;
    Lane lane_;  // a task for each job, which waits for its process
};

}  // namespace talus::serve
