#pragma once

// A `talus serve` of the built-in scene, and people who look at it, for measurements of what serving costs.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "serve/client.hpp"

namespace talus::test {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

inline constexpr const char* controller = "controller-token-of-load";
inline constexpr const char* viewer = "viewer-token-of-the-load";
inline constexpr std::uint16_t load_port = 18123;
inline constexpr double load_rate_hz = 30;

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
                if (HttpClient(load_port, viewer).get("/api/session").status == 200) return;
            } catch (const std::runtime_error&) {
                // Not yet.
            }
            std::this_thread::sleep_for(Milliseconds(100));
        }
        throw std::runtime_error("talus serve does not answer");
    }
    ~Program() {
        kill(process_, SIGTERM);
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

    /// Resident memory, bytes.
    [[nodiscard]] double resident() const {
        double pages = 0, skipped = 0;
        std::ifstream(fmt::format("/proc/{}/statm", process_)) >> skipped >> pages;
        return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
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
            sockets_.push_back(std::make_unique<WebSocket>(load_port, fmt::format("token={}&name=Load", viewer)));
            sockets_.back()->send(view_message(load_rate_hz));
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

inline double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace talus::test
