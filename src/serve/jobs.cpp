#include "serve/jobs.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/child_process.hpp"
#include "core/try.hpp"
#include "serve/access.hpp"
#include "session/json_text.hpp"

namespace talus::serve {
namespace {

namespace fs = std::filesystem;

constexpr int job_niceness = 10;  // a tenth of the open session's share where cores are short
constexpr std::uintmax_t longest_job = 1'000'000, longest_report = 256'000'000;
constexpr int case_failed = 4, interrupted = 130;  // exit codes
constexpr int most_of_a_kind = 100'000;

/// The sentence of the last "talus: error: ..." of what a command wrote to standard error.
std::string last_error(const std::string& words) {
    constexpr std::string_view mark = "talus: error: ";
    const std::size_t at = words.rfind(mark);
    if (at == std::string::npos) return {};
    const std::size_t from = at + mark.size();
    return tidy_name(words.substr(from, words.find('\n', from) - from), 2000);
}

void end(Job& job, Job::State state, std::string message) {
    job.end(state, std::move(message));
    job.ended_at = utc_now();
}

/// How the command's end is one of the job.
void end_with(Job& job, const Result<ChildOutcome>& outcome, bool closing) {
    if (!outcome) return end(job, Job::State::failed, outcome.error().message);
    if (outcome->success() || (outcome->exit_code == case_failed && job.kind == JobKind::validation)) {
        return end(job, Job::State::done, "");
    }
    if (*job.stop) return end(job, Job::State::cancelled, "");
    if (closing || outcome->exit_code == interrupted) {
        return end(job, Job::State::interrupted, "talus ended before it was complete");
    }
    if (outcome->signal != 0) {
        // The system ends programs by SIGKILL when the memory is full; other signals come from people or from faults.
        const char* const why = outcome->signal == SIGKILL   ? "; is the memory full?"
                                : outcome->signal == SIGTERM ? ": somebody or the system ended it"
                                                             : "";
        return end(
            job, Job::State::failed,
            fmt::format("its process was ended by signal {} ({}){}", outcome->signal, strsignal(outcome->signal), why));
    }
    std::string said = last_error(outcome->stderr_tail);
    end(job, Job::State::failed, said.empty() ? fmt::format("exit code {}", outcome->exit_code) : std::move(said));
}

}  // namespace

Jobs::Jobs(Executor& executor, fs::path folder, fs::path program)
    : folder_(std::move(folder)), program_(std::move(program)), lane_(executor, "jobs") {
    if (!program_.empty()) load();
}

Jobs::~Jobs() {
    closing_ = true;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& [id, entry] : entries_) {
            Job& job = entry->job;
            if (job.state == Job::State::waiting && job.process == getpid()) {
                end(job, Job::State::interrupted, "talus ended before it was begun");
                (void)keep(job).ok();
            }
        }
    }
    lane_.close();
}

void Jobs::load() {
    std::error_code error;
    for (fs::directory_iterator it(folder_, error), last; !error && it != last; it.increment(error)) {
        if (it->path().extension() != ".json") continue;
        const auto text = read_whole(it->path(), longest_job);
        auto job = text ? read_job(*text) : Result<Job>(text.error());
        if (!job || job->id != it->path().stem()) continue;
        if (job->is_open() && !process_lives(job->process)) {
            end(*job, Job::State::interrupted, "talus ended before it was complete");
        }
        auto entry = std::make_shared<Entry>();
        entry->job = std::move(*job);
        if (auto ticket = random_token()) entry->ticket = std::move(*ticket);
        entries_.emplace(entry->job.id, std::move(entry));
    }
}

std::optional<std::vector<messages::Job>> Jobs::describe() const {
    if (program_.empty()) return {};
    std::vector<EntryPtr> sorted;
    const std::lock_guard lock(mutex_);
    for (const auto& [id, entry] : entries_) sorted.push_back(entry);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const EntryPtr& a, const EntryPtr& b) { return a->job.begun_at > b->job.begun_at; });
    std::vector<messages::Job> list;
    list.reserve(sorted.size());
    std::error_code error;
    for (const EntryPtr& entry : sorted) {
        const Job& job = entry->job;
        const fs::path folder = folder_ / job.id;
        const bool done = job.state == Job::State::done && fs::exists(folder / report_of(job.kind), error);
        list.push_back({.id = job.id,
                        .kind = job_kind_name(job.kind),
                        .state = job.state_name(),
                        .title = job.title,
                        .message = job.message,
                        .begun_at = job.begun_at,
                        .ended_at = messages::if_any(job.ended_at),
                        .done = job.done,
                        .failed = job.failed,
                        .count = job.count,
                        .wall_remaining_s = job.wall_remaining,
                        .command = command_text(job.arguments),
                        .folder = folder.string(),
                        .report = done ? std::optional("api/reports/" + entry->ticket) : std::nullopt});
    }
    return list;
}

Result<Jobs::EntryPtr> Jobs::find(const std::string& id) const {
    const auto found = entries_.find(id);
    if (found == entries_.end()) return Error{"there is no job of this id; reload the page"};
    if (found->second->job.is_open() && found->second->job.process != getpid()) {
        return Error{"another talus that runs on this computer has this job"};
    }
    return found->second;
}

Status Jobs::check_room() const {
    if (program_.empty()) return Error{"this server starts no jobs"};
    const auto waiting = std::count_if(entries_.begin(), entries_.end(),
                                       [](const auto& e) { return e.second->job.state == Job::State::waiting; });
    if (waiting >= static_cast<long>(most_waiting)) {
        return Error{fmt::format("{} jobs wait already, the most there can be; cancel one", waiting)};
    }
    return {};
}

/// One that nobody else has taken; the file is there then.
Result<std::string> Jobs::new_id(JobKind kind) const {
    std::error_code error;
    fs::create_directories(folder_, error);
    for (int number = 1; !error && number < most_of_a_kind; ++number) {
        const std::string id = fmt::format("{}-{}", job_kind_name(kind), number);
        if (fs::exists(folder_ / id, error)) continue;
        if (std::FILE* file = std::fopen((folder_ / (id + ".json")).c_str(), "wx")) {
            std::fclose(file);
            return id;
        }
        if (errno != EEXIST) break;
    }
    return Error{fmt::format("{}: a job cannot be kept there; is the disk full?", folder_.string())};
}

Status Jobs::keep(const Job& job) const {
    return write_whole(folder_ / (job.id + ".json"), job_text(job));
}

void Jobs::queue(const EntryPtr& entry) {
    Job& job = entry->job;
    job.state = Job::State::waiting;
    job.process = getpid();
    job.message.clear();
    job.ended_at.clear();
    *job.stop = false;
    lane_.post([this, entry] { run(entry); });
}

Result<std::string> Jobs::add(const WantedJob& wanted, const std::optional<KnownScene>& scene) {
    const std::lock_guard lock(mutex_);
    TALUS_TRY(check_room());
    if (entries_.size() >= most_kept) {
        return Error{fmt::format("{} jobs are kept already, the most there can be; delete one", entries_.size())};
    }
    TALUS_ASSIGN(auto ticket, random_token());
    auto entry = std::make_shared<Entry>();
    Job& job = entry->job;
    TALUS_ASSIGN(job.id, new_id(wanted.kind));
    entry->ticket = std::move(ticket);
    job.kind = wanted.kind;
    job.arguments = arguments_of(wanted, scene ? scene->file : fs::path(), folder_ / job.id);
    job.begun_at = utc_now();
    job.count = wanted.kind == JobKind::validation    ? wanted.cases.size()
                : wanted.kind == JobKind::calibration ? wanted.calibration.search.runs
                                                      : wanted.ensemble.runs;
    if (scene) {
        job.scene = scene->id;
        job.title = scene->title;
    } else {
        job.title = wanted.quick           ? "quick cases"
                    : wanted.cases.empty() ? "all cases"
                                           : fmt::format("{}", fmt::join(wanted.cases, ", "));
    }
    job.process = getpid();
    if (const Status kept = keep(job); !kept) {
        std::error_code ignored;
        fs::remove(folder_ / (job.id + ".json"), ignored);
        return kept.error();
    }
    entries_.emplace(job.id, entry);
    queue(entry);
    return job.id;
}

/// Of the command line that reports its progress to this program.
std::vector<std::string> Jobs::words_of(const Job& job) {
    std::vector<std::string> words = job.arguments;
    words.emplace_back("--json");
    return words;
}

void Jobs::run(const EntryPtr& entry) {
    ChildProcess child;
    {
        const std::lock_guard lock(mutex_);
        Job& job = entry->job;
        if (job.state != Job::State::waiting || closing_) return;
        std::error_code error;
        fs::create_directories(folder_ / job.id, error);
        job.state = Job::State::running;
        if (const Status kept = keep(job); !kept) return end(job, Job::State::failed, kept.error().message);
        child.program = program_;
        child.arguments = words_of(job);
        child.folder = folder_;
    }
    child.niceness = job_niceness;
    child.shall_end = [&] { return *entry->job.stop || closing_; };
    child.on_line = [&](const std::string& line) {
        const auto event = parse_json(line);
        if (!event) return;
        const std::lock_guard lock(mutex_);
        take_progress(entry->job, *event);
    };
    const auto outcome = run_child(child);
    const std::lock_guard lock(mutex_);
    end_with(entry->job, outcome, closing_);
    // That its record cannot be written does not change what became of it.
    if (const Status kept = keep(entry->job); !kept) entry->job.message = kept.error().message;
}

Status Jobs::cancel(const std::string& id) {
    const std::lock_guard lock(mutex_);
    TALUS_ASSIGN(const EntryPtr entry, find(id));
    Job& job = entry->job;
    if (!job.is_open()) return Error{"this job has ended already"};
    job.cancel();
    if (job.is_open()) return {};
    job.ended_at = utc_now();
    return keep(job);
}

Status Jobs::resume(const std::string& id) {
    const std::lock_guard lock(mutex_);
    TALUS_ASSIGN(const EntryPtr entry, find(id));
    if (entry->job.is_open() || entry->job.state == Job::State::done) {
        return Error{"this job is not one that ended early"};
    }
    TALUS_TRY(check_room());
    queue(entry);
    return keep(entry->job);
}

Status Jobs::remove(const std::string& id) {
    const std::lock_guard lock(mutex_);
    TALUS_ASSIGN(const EntryPtr entry, find(id));
    if (entry->job.is_open()) return Error{"this job goes on; cancel it first"};
    std::error_code error;
    fs::remove_all(folder_ / id, error);
    if (!error) fs::remove(folder_ / (id + ".json"), error);
    if (error) return Error{fmt::format("{}: cannot be deleted: {}", (folder_ / id).string(), error.message())};
    entries_.erase(id);
    return {};
}

Result<std::string> Jobs::report(const std::string& ticket) const {
    fs::path file;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& [id, entry] : entries_) {
            if (!ticket.empty() && entry->ticket == ticket) file = folder_ / id / report_of(entry->job.kind);
        }
    }
    if (file.empty()) return Error{"there is no such report; open it on the start page"};
    return read_whole(file, longest_report);
}

Result<Jobs::Finished> Jobs::ensemble(const std::string& id) const {
    const std::lock_guard lock(mutex_);
    TALUS_ASSIGN(const EntryPtr entry, find(id));
    const Job& job = entry->job;
    if (job.kind != JobKind::ensemble || job.state != Job::State::done) return Error{"this is no finished ensemble"};
    return Finished{job.scene, folder_ / id};
}

}  // namespace talus::serve
