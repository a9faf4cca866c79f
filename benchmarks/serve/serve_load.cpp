// Measures the cost of serving, on a `talus serve` of the built-in scene that it starts itself:
//   (a) how much longer a run takes with one viewer at 30 frames per second,
//   (b) processor time per second that 50 such viewers cost the server, stepping left out.
//   serve_load [PARTICLES [THREADS [REPEATS]]]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "served.hpp"

namespace talus::test {
namespace {

constexpr std::size_t crowd = 50;

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

class Measurement {
  public:
    Measurement(int particles, int threads)
        : program_({"serve", "--quiet", "--port", std::to_string(load_port), "--token", controller, "--token", viewer,
                    "--threads", std::to_string(threads), "--set", "solver.end_time_s=5", "--set",
                    fmt::format("solver.target_particle_count={}", particles)}) {
        act({{"action", "set_speed"}, {"factor", nullptr}});
    }

    struct Run {
        double wall_time = 0, processor_time = 0, loop_time = 0, server_time = 0;  // s; the last three of processors
        double frame_rate = 0, frame_bytes = 0;
    };
    /// The whole run from time 0 to its end, with this number of viewers.
    Run run(std::size_t viewers) {
        act({{"action", "restart"}});
        WebSocket watch(load_port, fmt::format("token={}&name=Watch", viewer));
        const Viewers looking(viewers);
        while (watch.wait_for("state")["step"] != 0) {
        }
        const std::uint64_t frames = looking.frames(), bytes = looking.bytes();
        const double processor = program_.processor_time(), loop = program_.processor_time("loop");
        const double server = program_.processor_time("server");
        const auto begin = Clock::now();
        act({{"action", "run"}});
        std::string status;
        while (status != "ended" && status != "at_rest") {
            const json state = watch.wait_for("state", Milliseconds(120000));
            if (state.is_null()) throw std::runtime_error("no state came");
            status = state["status"];
            steps_ = state["step"];
        }
        Run result;
        result.wall_time = seconds_since(begin);
        result.processor_time = program_.processor_time() - processor;
        result.loop_time = program_.processor_time("loop") - loop;
        result.server_time = program_.processor_time("server") - server;
        const auto got = static_cast<double>(looking.frames() - frames);
        if (viewers > 0) result.frame_rate = got / static_cast<double>(viewers) / result.wall_time;
        if (got > 0) result.frame_bytes = static_cast<double>(looking.bytes() - bytes) / got;
        return result;
    }
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

  private:
    void act(const json& action) {
        const Answer answer = HttpClient(load_port, controller).post("/api/scenarios/A/actions", action);
        if (answer.status != 200) throw std::runtime_error(answer.body);
    }
    Program program_;
    std::uint64_t steps_ = 0;
};

void measure(int particles, int threads, int repeats) {
    Measurement measurement(particles, threads);
    measurement.run(0);  // caches and clocks warm up
    std::vector<double> alone, with_one, loss, loop_loss, frame_time, one_rate, cost, server, rate, bytes;
    for (int i = 0; i < repeats; ++i) {
        const auto none = measurement.run(0), one = measurement.run(1), many = measurement.run(crowd);
        alone.push_back(none.wall_time);
        with_one.push_back(one.wall_time);
        loss.push_back(1 - none.wall_time / one.wall_time);
        loop_loss.push_back(1 - none.loop_time / one.loop_time);
        frame_time.push_back((one.loop_time - none.loop_time) / (one.frame_rate * one.wall_time));
        one_rate.push_back(one.frame_rate);
        cost.push_back((many.processor_time - none.processor_time) / many.wall_time);
        server.push_back(many.server_time / many.wall_time);
        rate.push_back(many.frame_rate);
        bytes.push_back(many.frame_bytes);
    }
    const auto steps = static_cast<double>(measurement.steps());
    fmt::print("{} particles wanted, {} threads, {} steps, medians of {} runs each\n", particles, threads,
               measurement.steps(), repeats);
    fmt::print("steps per second: {:.1f} without viewers, {:.1f} with one at {:.1f} frames/s: loss {:.1f} %\n",
               steps / median(alone), steps / median(with_one), median(one_rate), 100 * median(loss));
    // Where other programs use the processors too, this tells more: frames are made by the thread that steps.
    fmt::print("processor time of the stepping thread: {:.1f} % of it for one viewer, {:.1f} ms per frame\n",
               100 * median(loop_loss), 1000 * median(frame_time));
    fmt::print(
        "{} viewers at {:.1f} frames/s of {:.0f} bytes: {:.2f} cores beyond the stepping, {:.2f} of them sending\n",
        crowd, median(rate), median(bytes), median(cost), median(server));
}

}  // namespace
}  // namespace talus::test

int main(int argc, char** argv) {
    const auto number = [&](int index, int otherwise) { return argc > index ? std::atoi(argv[index]) : otherwise; };
    try {
        talus::test::measure(number(1, 20000), number(2, 2), number(3, 5));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "serve_load: %s\n", error.what());
        return 1;
    }
    return 0;
}
