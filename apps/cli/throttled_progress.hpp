#pragma once

#include <chrono>
#include <string>

#include "command.hpp"
#include "progress.hpp"

namespace talus::cli {

/// Progress of many runs, for a user or a program, at a limited rate.
class ThrottledProgress {
  public:
    ThrottledProgress(bool quiet, bool json) : style_(progress_style(quiet, json)), reporter_(style_) {
        if (style_ == ProgressStyle::lines) next_ += std::chrono::seconds(1);  // the first estimates are poor
    }

    /// `text` and `json` make the line, when one is due.
    template <class Text, class Json>
    void report(const Text& text, const Json& json) {
        const auto now = std::chrono::steady_clock::now();
        if (now < next_) return;
        if (style_ == ProgressStyle::json) {
            (void)print(json() + "\n");  // the result that follows is lost as well, and says so
        } else {
            reporter_.say(text());
        }
        next_ = now + std::chrono::milliseconds(style_ == ProgressStyle::lines  ? 5000
                                                : style_ == ProgressStyle::json ? 500
                                                                                : 200);
    }
    void say(const std::string& what) { reporter_.say(what); }
    /// A line that stays, above the progress.
    void note(const std::string& what) {
        reporter_.clear();
        cli::note(what);
    }
    void clear() { reporter_.clear(); }

  private:
    ProgressStyle style_;
    ProgressReporter reporter_;
    std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
};

}  // namespace talus::cli
