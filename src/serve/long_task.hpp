#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace talus::serve {

/// Something that takes long, which people begin and may cancel: a job, a calibration, an export of the moving flow.
/// Its owner guards it with a lock, and has what it is about and what it finds.
struct LongTask {
    enum class State { idle, waiting, running, cancelling, done, cancelled, interrupted, failed };
    static constexpr std::array state_names = {"idle", "waiting",   "running",     "cancelling",
                                               "done", "cancelled", "interrupted", "failed"};

    State state = State::idle;
    std::string message;                     ///< how it ended, where there is more to say than its state
    std::optional<double> wall_remaining{};  ///< s
    /// It shall end soon; read without the lock by what computes it.
    std::shared_ptr<std::atomic<bool>> stop = std::make_shared<std::atomic<bool>>(false);

    [[nodiscard]] const char* state_name() const { return state_names.at(static_cast<std::size_t>(state)); }
    [[nodiscard]] bool is_open() const {
        return state == State::waiting || state == State::running || state == State::cancelling;
    }
    /// Returns whether its state changes: what waits is cancelled now, what runs when it has seen `stop`.
    bool cancel() {
        *stop = true;
        if (state != State::waiting && state != State::running) return false;
        state = state == State::waiting ? State::cancelled : State::cancelling;
        return true;
    }
    /// What is done keeps the message that it has, unless there is another one.
    void end(State how, std::string why) {
        state = how;
        wall_remaining.reset();
        if (how != State::done || !why.empty()) message = std::move(why);
    }
};

}  // namespace talus::serve
