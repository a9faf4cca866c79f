#pragma once

#include <chrono>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "run/run_scene.hpp"
#include "run/variants.hpp"

namespace talus::cli {

enum class ProgressStyle {
    none,
    bar,    ///< one line on stderr, redrawn about ten times a second
    lines,  ///< a line on stderr every few seconds
    json,   ///< an object per line on stdout, about twice a second
};

/// A bar where stderr is a terminal that can redraw a line, plain lines elsewhere.
[[nodiscard]] ProgressStyle progress_style(bool quiet, bool json);

/// Reports the progress of a run to a user or a program.
class ProgressReporter {
  public:
    explicit ProgressReporter(ProgressStyle style);
    /// Call after every step; most calls return immediately. `series`: if the run is one of several.
    void report(const run::Progress& progress, const std::optional<run::SeriesProgress>& series = std::nullopt);
    /// Replaces the bar by the current activity ("writing maps and report"); lines print it.
    void say(const std::string& what);
    /// Removes the bar from the terminal.
    void clear();

  private:
    ProgressStyle style_;
    std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
    bool drawn_ = false;
};

/// "0:07", "12:34", "3:00:12".
[[nodiscard]] std::string clock_text(double seconds);
/// `words` with the clock in it, such as ", about {} left"; empty where too little is done to say.
[[nodiscard]] std::string left_text(fmt::format_string<std::string> words, double seconds);

}  // namespace talus::cli
