#include "progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <sys/ioctl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/decimals.hpp"
#include "core/number_or_null.hpp"
#include "core/visible_text.hpp"

namespace talus::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto bar_interval = 100ms;
constexpr auto line_interval = 3s;
constexpr auto json_interval = 500ms;

int terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string front_text(const run::Progress& p) {
    return std::isnan(p.front_chainage)
               ? "no front yet"
               : fmt::format("front to chainage {:.{}f} m", p.front_chainage, decimals_for(p.path_length, 0));
}

std::string bar_text(const run::Progress& p, const std::optional<run::SeriesProgress>& series) {
    const int columns = terminal_columns();
    const double share_done = series ? series->share_done : p.share_done;
    std::string facts = fmt::format(" {:3.0f} %  ", 100 * share_done);
    if (series) facts += fmt::format("run {} of {}: {}  ", series->run, series->count, series->name);
    facts += fmt::format("t {:.1f} s  ", p.time);
    if (!series) facts += fmt::format("{:.2f} x real time  ", p.real_time_factor);
    facts += front_text(p) + left_text("  ETA {}", series ? series->wall_remaining : p.wall_remaining);
    const int width = std::min(40, columns - 3 - static_cast<int>(facts.size()));
    if (width < 5) return facts.substr(1, static_cast<std::size_t>(std::max(0, columns - 1)));
    const int filled = static_cast<int>(std::lround(std::clamp(share_done, 0.0, 1.0) * width));
    return "[" + std::string(filled, '#') + std::string(width - filled, '.') + "]" + facts;
}

std::string line_text(const run::Progress& p, const std::optional<run::SeriesProgress>& series) {
    std::string text;
    if (series) text = fmt::format("run {} of {}, {}: ", series->run, series->count, series->name);
    text += fmt::format("t {:.1f} s of at most {:.0f} s, {:.2f} x real time, {}", p.time, p.end_time,
                        p.real_time_factor, front_text(p));
    return text +
           (series ? left_text(", about {} left of all runs", series->wall_remaining)
                   : left_text(", about {} left", p.wall_remaining)) +
           "\n";
}

// Not fmt::print: it throws when a pipe has been closed, and that must not end a run.
void write(std::FILE* stream, const std::string& text) {
    (void)std::fputs(text.c_str(), stream);
    (void)std::fflush(stream);
}

std::string json_text(const run::Progress& p, const std::optional<run::SeriesProgress>& series) {
    nlohmann::ordered_json event = {
        {"event", "progress"},
        {"time_s", p.time},
        {"end_time_s", p.end_time},
        {"share_done", p.share_done},
        {"real_time_factor", number_or_null<nlohmann::json>(p.real_time_factor)},
        {"front_chainage_m", number_or_null<nlohmann::json>(p.front_chainage)},
        {"wall_remaining_s", number_or_null<nlohmann::json>(p.wall_remaining)},
        {"step", p.step},
        {"particles", p.particles},
    };
    if (series) {
        event["run"] = series->run;
        event["runs"] = series->count;
        event["variant"] = series->name;
        event["share_done_of_all_runs"] = series->share_done;
        event["wall_remaining_of_all_runs_s"] = number_or_null<nlohmann::json>(series->wall_remaining);
    }
    return event.dump();
}

}  // namespace

ProgressStyle progress_style(bool quiet, bool json) {
    if (json) return ProgressStyle::json;
    if (quiet) return ProgressStyle::none;
    const char* terminal = std::getenv("TERM");
    const bool can_redraw = isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
    return can_redraw ? ProgressStyle::bar : ProgressStyle::lines;
}

std::string clock_text(double seconds) {
    if (!std::isfinite(seconds) || seconds < 0) return "-";
    const long total = std::lround(std::min(seconds, 3.6e6));
    if (total >= 3600) return fmt::format("{}:{:02}:{:02}", total / 3600, total / 60 % 60, total % 60);
    return fmt::format("{}:{:02}", total / 60, total % 60);
}

std::string left_text(fmt::format_string<std::string> words, double seconds) {
    return std::isfinite(seconds) ? fmt::format(words, clock_text(seconds)) : "";
}

ProgressReporter::ProgressReporter(ProgressStyle style) : style_(style) {
    if (style == ProgressStyle::lines) next_ += 1s;  // a short run needs none, and the first estimates are poor
}

void ProgressReporter::report(const run::Progress& progress, const std::optional<run::SeriesProgress>& series) {
    if (style_ == ProgressStyle::none) return;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    switch (style_) {
        case ProgressStyle::none:
            break;
        case ProgressStyle::bar:
            write(stderr, "\r" + visible(bar_text(progress, series)) + "\x1b[K");
            drawn_ = true;
            next_ = now + bar_interval;
            break;
        case ProgressStyle::lines:
            write(stderr, visible(line_text(progress, series)));
            next_ = now + line_interval;
            break;
        case ProgressStyle::json:
            write(stdout, visible(json_text(progress, series)) + "\n");
            next_ = now + json_interval;
            break;
    }
}

void ProgressReporter::say(const std::string& what) {
    if (style_ == ProgressStyle::bar) {
        write(stderr, "\r" + visible(what) + "\x1b[K");
        drawn_ = true;
    } else if (style_ == ProgressStyle::lines) {
        write(stderr, visible(what) + "\n");
    }
}

void ProgressReporter::clear() {
    if (!drawn_) return;
    write(stderr, "\r\x1b[K");
    drawn_ = false;
}

}  // namespace talus::cli
