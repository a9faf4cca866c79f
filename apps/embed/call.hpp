#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include <fmt/format.h>

#include "core/result.hpp"
#include "hooks.hpp"
#include "talus.h"

/// What every call of talus.h has in common: codes and sentences, NULL, sizes of structs, progress and cancelling.
namespace talus::embed {

inline constexpr std::size_t largest_struct = 1 << 16;

[[nodiscard]] inline Status need(const void* pointer, const char* name) {
    if (pointer == nullptr) return Error{std::string(name) + " is NULL"};
    return {};
}

/// That a struct has all members of this version; a larger one is of a later version, and the rest of it is left alone.
template <class Struct>
[[nodiscard]] Status check_size(const Struct* given, const char* name) {
    if (Status s = need(given, name); !s) return s;
    if (given->size < sizeof(Struct) || given->size > largest_struct) {
        return Error{
            fmt::format("{}.size = {}: must be sizeof, {} in this version", name, given->size, sizeof(Struct))};
    }
    return {};
}

/// Writes an answer into a struct of the caller, which keeps its size.
template <class Struct>
void give(Struct answer, Struct* to) {
    answer.size = to->size;
    *to = answer;
}

/// The progress of one call.
class Watch {
  public:
    explicit Watch(const talus_progress* progress) : progress_(progress) {}
    [[nodiscard]] Status check() const {
        if (progress_ == nullptr) return {};
        if (Status s = check_size(progress_, "progress"); !s) return s;
        return need(reinterpret_cast<const void*>(progress_->call), "progress.call");
    }
    /// Whether the call goes on. Asks the caller now and then.
    [[nodiscard]] bool go_on(double share) {
        if (progress_ == nullptr || cancelled_) return !cancelled_;
        const auto now = std::chrono::steady_clock::now();
        if (now < next_) return true;
        cancelled_ = progress_->call(progress_->user, share > 0 ? std::min(share, 1.0) : 0) != 0;
        next_ = std::chrono::steady_clock::now() + std::chrono::milliseconds(20);
        return !cancelled_;
    }
    [[nodiscard]] bool cancelled() const { return cancelled_; }

  private:
    const talus_progress* progress_;
    std::chrono::steady_clock::time_point next_{};
    bool cancelled_ = false;
};

inline int say(talus_error* error, int code, const char* text) {
    if (error != nullptr) {
        error->code = code;
        (void)std::snprintf(error->text, sizeof error->text, "%s", text);
    }
    if (code == TALUS_CANCELLED) tell(TALUS_LOG_INFO, text);
    if (code != TALUS_OK && code != TALUS_CANCELLED) tell(TALUS_LOG_ERROR, text);
    return code;
}

/// Answers with a code; nothing that is thrown leaves the library.
template <class Work>
int guarded(talus_error* error, const Work& work, const Watch* watch = nullptr) {
    // An error that is too small cannot hold the sentence about itself.
    if (error != nullptr && (error->size < sizeof(talus_error) || error->size > largest_struct)) return TALUS_BAD_INPUT;
    try {
        const Status status = work();
        if (watch != nullptr && watch->cancelled()) return say(error, TALUS_CANCELLED, "cancelled by the caller");
        return status ? say(error, TALUS_OK, "") : say(error, TALUS_BAD_INPUT, status.error().message.c_str());
    } catch (const std::bad_alloc&) {
        return say(error, TALUS_FAILURE, "out of memory");
    } catch (const std::exception& thrown) {
        return say(error, TALUS_FAILURE, thrown.what());
    } catch (...) {
        return say(error, TALUS_FAILURE, "an error of no known kind");
    }
}

}  // namespace talus::embed
