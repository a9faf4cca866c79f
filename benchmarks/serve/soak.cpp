// A `talus serve` of the built-in scene under people for a long time: 20 viewers, an edit every second, a restart every
// five. Prints resident memory with its slope, and the frames per second of a viewer beside those on the same server
// with nobody else. Exit code 1: memory grows, or that viewer had less than half.
//   soak [SECONDS [PARTICLES]]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "served.hpp"

namespace talus::test {
namespace {

constexpr std::size_t crowd = 20;
constexpr double window = 10;         // s, of which memory and frames are means
constexpr double edit_interval = 1;   // s
constexpr int edits_per_restart = 5;  // in place of every fifth edit
constexpr double grown_share = 0.05;  // of the memory, in an hour: what counts as growth

/// Changes the session as a person does, at random, the same in every soak.
class Editor {
  public:
    void edit() {
        if (++edits_ % edits_per_restart == 0) return restart();
        switch (random_() % 5) {
            case 0:
                act({{"action", "set_parameter"},
                     {"key", "material.friction_coefficient"},
                     {"value", 0.15 + 0.01 * static_cast<double>(random_() % 20)}});
                break;
            case 1:
                change_barrier();
                break;
            case 2:
                act({{"action", "undo"}});
                break;
            case 3:
                act({{"action", "redo"}});
                break;
            default:
                act({{"action", "set_parameter"}, {"key", "material.viscosity"}, {"value", 0.01 * shift()}});
        }
    }
    void restart() {
        act({{"action", "restart"}});
        act({{"action", "run"}});
    }
    [[nodiscard]] int done() const { return done_; }
    /// Such as an undo where there is nothing to undo.
    [[nodiscard]] int refused() const { return refused_; }
    [[nodiscard]] const std::string& last_refusal() const { return last_refusal_; }

    void act(const nlohmann::json& action) {
        const Answer answer = client_.post("/api/scenarios/A/actions", action);
        if (answer.status == 0) throw std::runtime_error("talus serve does not answer");
        if (answer.status == 200) {
            ++done_;
            return;
        }
        ++refused_;
        last_refusal_ = action.dump() + ": " + answer.body;
    }

  private:
    /// Draws a barrier, or removes the one there is, which undo may have brought back: the session has no more in it
    /// after an hour than after a minute.
    void change_barrier() {
        const auto setup = client_.get("/api/scenarios/A/setup").json();
        for (const auto& barrier : setup["barriers"]) {
            if (!barrier["from_scene"]) return act({{"action", "remove_barrier"}, {"id", barrier["id"]}});
        }
        act({{"action", "put_barrier"},
             {"line", {{east + shift(), north}, {east + 12, north + 8}}},
             {"height_m", 2},
             {"thickness_m", 1}});
    }
    double shift() { return static_cast<double>(random_() % 8); }

    static constexpr double east = 824295, north = 825816;
    HttpClient client_{load_port, controller};
    std::mt19937 random_{1};  // NOLINT(cert-msc51-cpp): the same edits in every soak
    std::string last_refusal_;
    int edits_ = 0, done_ = 0, refused_ = 0;
};

/// What happened in windows of time.
struct Record {
    std::vector<double> memory;      // bytes
    std::vector<double> frame_rate;  // Hz, of the one viewer that is looked at
};

Record observe(const Program& program, const Viewers& honest, Editor& editor, double seconds, bool edits) {
    Record record;
    const auto begin = Clock::now();
    double next_edit = 0;
    while (seconds_since(begin) < seconds) {
        const auto start = Clock::now();
        const std::uint64_t frames = honest.frames();
        double memory = 0;
        int samples = 0;
        while (seconds_since(start) < window) {
            if (seconds_since(begin) >= next_edit) {
                edits ? editor.edit() : editor.restart();
                next_edit += edits ? edit_interval : edits_per_restart * edit_interval;
            }
            memory += program.resident();
            ++samples;
            std::this_thread::sleep_for(Milliseconds(200));
        }
        record.memory.push_back(memory / samples);
        record.frame_rate.push_back(static_cast<double>(honest.frames() - frames) / seconds_since(start));
    }
    return record;
}

struct Line {
    double mean = 0, slope = 0, slope_error = 0;  // per window
};

/// Least squares through values at 0, 1, 2, ...
Line fit(const std::vector<double>& values) {
    const auto n = static_cast<double>(values.size());
    Line line;
    for (const double v : values) line.mean += v / n;
    double xx = 0, xy = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double x = static_cast<double>(k) - (n - 1) / 2;
        xx += x * x;
        xy += x * (values[k] - line.mean);
    }
    line.slope = xy / xx;
    double squares = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double x = static_cast<double>(k) - (n - 1) / 2;
        squares += std::pow(values[k] - line.mean - line.slope * x, 2);
    }
    line.slope_error = std::sqrt(squares / (n - 2) / xx);
    return line;
}

int soak(double seconds, int particles) {
    const Program program({"serve", "--quiet", "--port", std::to_string(load_port), "--token", controller, "--token",
                           viewer, "--set", fmt::format("solver.target_particle_count={}", particles)});
    Editor editor;
    const Viewers honest(1);
    editor.act({{"action", "set_speed"}, {"factor", 1}});
    editor.restart();
    const Record alone = observe(program, honest, editor, std::max(3 * window, seconds / 10), false);
    const Viewers others(crowd - 1);
    const Record busy = observe(program, honest, editor, seconds, true);

    // The first quarter fills caches and free lists.
    const std::size_t warm = busy.memory.size() / 4;
    if (busy.memory.size() - warm < 5) throw std::runtime_error("too short; 70 s at least");
    const Line memory = fit({busy.memory.begin() + static_cast<std::ptrdiff_t>(warm), busy.memory.end()});
    constexpr double megabyte = 1e6, windows_per_hour = 3600 / window;
    const double growth = memory.slope * windows_per_hour, error = memory.slope_error * windows_per_hour;
    const double alone_rate = fit(alone.frame_rate).mean;
    const double worst = *std::min_element(busy.frame_rate.begin(), busy.frame_rate.end());
    fmt::print("{:.0f} s, {} particles wanted, {} viewers, {} actions, {} refused{}\n", seconds, particles, crowd,
               editor.done(), editor.refused(),
               editor.refused() > 0 ? " (the last: " + editor.last_refusal() + ")" : "");
    fmt::print("resident memory after the first quarter: {:.1f} MB, slope {:+.2f} MB an hour, standard error {:.2f}\n",
               memory.mean / megabyte, growth / megabyte, error / megabyte);
    fmt::print("frames of a viewer: {:.1f} /s alone, {:.1f} /s beside the others, at worst {:.1f} in {:.0f} s\n",
               alone_rate, fit(busy.frame_rate).mean, worst, window);
    const bool grows = growth > 3 * error && growth > grown_share * memory.mean;
    if (grows) fmt::print("memory grows\n");
    if (worst < alone_rate / 2) fmt::print("the viewer had less than half\n");
    return grows || worst < alone_rate / 2 ? 1 : 0;
}

}  // namespace
}  // namespace talus::test

int main(int argc, char** argv) {
    const auto number = [&](int index, int otherwise) { return argc > index ? std::atoi(argv[index]) : otherwise; };
    try {
        return talus::test::soak(number(1, 600), number(2, 2000));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "soak: %s\n", error.what());
        return 2;
    }
}
