// Measures the cost of serving, on a `talus serve` of the built-in scene that it starts itself:
//   (a) how much longer a run takes with one viewer at 30 frames per second,
//   (b) processor time per second that 50 such viewers cost the server, stepping left out.
//   serve_load [PARTICLES [THREADS [REPEATS]]]
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "serve/client.hpp"

namespace talus::test {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr const char* controller = "controller-token-of-load";
constexpr const char* viewer = "viewer-token-of-the-load";
constexpr std::uint16_t port = 18123;
constexpr double rate_hz = 30;
constexpr std::size_t crowd = 50;

/// The program under test, ended with this object.
class Program {
  public:
    explicit Program(const std::vector<std::string>& arguments) : process_(fork()) {
        if (process_ == 0) {
            std::vector<char*> words{const_cast<char*>(TALUS_PROGRAM)};
            for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
            words.push_back(nullptr);
            execv(TALUS_PROGRAM, words.data());
            _exit(127);
        }
        for (int i = 0; i < 100; ++i) {
            try {
                if (HttpClient(port, viewer).get("/api/session").status == 200) return;
            } catch (const std::runtime_error&) {
                // Not yet.
            }
            std::this_thread::sleep_for(Milliseconds(100));
        }
        throw std::runtime_error("talus serve does not answer");
    }
    ~Program() {
        kill(process_, SIGINT);
        waitpid(process_, nullptr, 0);
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    /// Processor time, s; of all threads, or of those of a name.
    [[nodiscard]] double processor_time(const std::string& thread = "") const {
        const std::string folder = fmt::format("/proc/{}/task", process_);
        double total = thread.empty() ? time_of(fmt::format("/proc/{}/stat", process_)) : 0;
        if (thread.empty()) return total;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            std::string name;
            std::getline(std::ifstream(entry.path() / "comm"), name);
            if (name == thread) total += time_of(entry.path() / "stat");
        }
        return total;
    }

  private:
    static double time_of(const std::filesystem::path& stat) {
        std::string text;
        std::getline(std::ifstream(stat), text);
        std::istringstream fields(text.substr(text.rfind(')') + 2));
        std::string skipped;
        for (int i = 0; i < 11; ++i) fields >> skipped;
        double user = 0, system = 0;
        fields >> user >> system;
        return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
    }
    pid_t process_;
};

/// Viewers that read and discard, on their own thread.
class Viewers {
  public:
    explicit Viewers(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            sockets_.push_back(std::make_unique<WebSocket>(port, fmt::format("token={}&name=Load", viewer)));
            sockets_.back()->send(view_message(rate_hz));
        }
        for (std::size_t i = 0; i < count; ++i) threads_.emplace_back([this, i] { read(*sockets_[i]); });
    }
    ~Viewers() {
        done_ = true;
        for (std::thread& thread : threads_) thread.join();
    }
    Viewers(const Viewers&) = delete;
    Viewers& operator=(const Viewers&) = delete;

    [[nodiscard]] std::uint64_t frames() const { return frames_; }
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

  private:
    void read(WebSocket& socket) {
        while (!done_) {
            const auto message = socket.receive(Milliseconds(100));
            if (!message || message->text) continue;
            ++frames_;
            bytes_ += message->data.size();
        }
    }
    std::vector<std::unique_ptr<WebSocket>> sockets_;
    std::vector<std::thread> threads_;
    std::atomic<bool> done_{false};
    std::atomic<std::uint64_t> frames_{0}, bytes_{0};
};

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

class Measurement {
  public:
    Measurement(int particles, int threads)
        : program_({"serve", "--quiet", "--port", std::to_string(port), "--token", controller, "--token", viewer,
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
        WebSocket watch(port, fmt::format("token={}&name=Watch", viewer));
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
        const Answer answer = HttpClient(port, controller).post("/api/scenarios/A/actions", action);
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
