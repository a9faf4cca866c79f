#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include <nlohmann/json.hpp>

#include "serve/session.hpp"
#include "serve/worker.hpp"
#include "twin/depth_averaged.hpp"

namespace talus::serve {

/// The depth-averaged model of the present setup of every scenario, beside the live runs: one run at a time, on one
/// thread of lower priority. A changed setup ends its run and discards its result at once; the scenario that was
/// changed last comes first. Off until it is switched on. Functions may be called from any thread.
class DepthAveraged {
  public:
    explicit DepthAveraged(Session& session);
    ~DepthAveraged();
    DepthAveraged(const DepthAveraged&) = delete;
    DepthAveraged& operator=(const DepthAveraged&) = delete;

    /// For all scenarios, also those to come. Off: results are discarded.
    void turn(bool on);
    /// Ends the thread; nothing is sent any more. Before the session is closed.
    void close();

    /// As `GET /api/scenarios/{s}/depth_averaged`.
    [[nodiscard]] nlohmann::json describe(int scenario) const;
    /// The result for the present setup; nullptr: there is none yet.
    [[nodiscard]] std::shared_ptr<const twin::DepthAveragedRun> result(int scenario) const;

  private:
    using Clock = std::chrono::steady_clock;
    using Work = std::function<Result<scene::Scene>()>;
    enum class State { off, waiting, running, done, refused, failed };
    struct Slot {
        State state = State::off;
        std::string key;          ///< the setup that this is about
        std::uint64_t asked = 0;  ///< counts questions; the newest is answered first
        Work scene;               ///< none: nothing to be computed
        std::string message;      ///< why it was refused or failed
        double share = 0;         ///< of the simulated time
        std::shared_ptr<const twin::DepthAveragedRun> made;
    };
    static const char* name_of(State state);

    void look_again();
    void look(Scenarios& all);
    void drop(int scenario);
    void run_next();
    void compute(int scenario, std::uint64_t asked, const Work& scene);
    void take_share(int scenario, std::uint64_t asked, double share);
    [[nodiscard]] int next() const;
    [[nodiscard]] nlohmann::json describe_now(int scenario) const;
    void tell(int scenario);
    Slot& slot(int scenario) { return slots_[static_cast<std::size_t>(scenario)]; }
    [[nodiscard]] const Slot& slot(int scenario) const { return slots_[static_cast<std::size_t>(scenario)]; }

    Session& session_;
    mutable std::mutex mutex_;  // guards the following members, except stop_
    std::array<Slot, Scenarios::max_count> slots_;
    std::uint64_t asked_ = 0;
    int running_ = -1;                // the scenario whose run is under way
    std::atomic<bool> stop_ = false;  // ends that run
    bool on_ = false, closed_ = false;
    Clock::time_point told_{};
    std::unique_ptr<Worker> worker_;  // a task for each question
};

}  // namespace talus::serve
