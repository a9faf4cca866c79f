#include <fstream>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

std::size_t resident_bytes() {
    std::ifstream in("/proc/self/statm");
    std::size_t total = 0, resident = 0;
    in >> total >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Seconds of processor time that this process, server and clients, has used.
double processor_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Steps of the frames that come to a viewer for a while.
std::vector<std::uint64_t> watch(WebSocket& viewer, Milliseconds time) {
    std::vector<std::uint64_t> steps;
    const auto end = Clock::now() + time;
    while (Clock::now() < end) {
        if (const auto header = read_frame_header(viewer.wait_for_frame(Milliseconds(100))))
            steps.push_back(header->step);
    }
    return steps;
}

class Crowd : public Serve {
  protected:
    /// Frames that soon fill a buffer, and steps that leave time for them on a busy machine.
    void SetUp() override { start({"solver.particle_spacing_m=0.4"}); }
};

TEST_F(Crowd, a_slow_viewer_slows_nobody_and_costs_no_memory) {
    WebSocket fast = join(viewer, "Fast");
    fast.send(view_message(30));
    act({{"action", "run"}});
    ASSERT_FALSE(fast.wait_for_frame().empty());
    const std::size_t alone = watch(fast, Milliseconds(3000)).size();

    std::vector<WebSocket> slow;
    for (int i = 0; i < 5; ++i) {
        slow.push_back(join(viewer, "Slow", 8192));
        slow.back().send(view_message(60));
    }
    watch(fast, Milliseconds(1500));  // until their buffers are full
    [[maybe_unused]] const std::size_t memory = resident_bytes();
    const std::size_t beside = watch(fast, Milliseconds(3000)).size();
    EXPECT_GE(static_cast<double>(beside), 0.9 * static_cast<double>(alone)) << alone << " frames alone";
#ifndef __SANITIZE_ADDRESS__  // which keeps what is freed for a while
    EXPECT_LT(static_cast<double>(resident_bytes()), static_cast<double>(memory) + 8e6);
#endif

    // The newest frame wins: once it reads again, a slow viewer is at the present after what the system had taken in.
    const std::uint64_t present = as_viewer().get("/api/scenarios/A/state").json()["step"];
    std::uint64_t seen = 0;
    const auto end = Clock::now() + std::chrono::seconds(10);
    std::size_t bytes = 0;
    while (seen < present && Clock::now() < end) {
        const std::string frame = slow[0].wait_for_frame();
        const auto header = read_frame_header(frame);
        ASSERT_TRUE(header);
        bytes += frame.size();
        seen = header->step;
    }
    EXPECT_GE(seen, present);
    EXPECT_LT(bytes, 1'500'000U);
}

TEST_F(Crowd, a_thousand_idle_connections_leave_room_for_viewers) {
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = std::min<rlim_t>(files.rlim_max, 8192);
    setrlimit(RLIMIT_NOFILE, &files);
    if (files.rlim_cur < 2500) GTEST_SKIP() << "the system allows " << files.rlim_cur << " open files; 2500 are needed";
    start({"solver.particle_spacing_m=0.4"});  // takes the limit as it is now

    std::vector<Socket> silent;
    for (int i = 0; i < 500; ++i) silent.emplace_back(port());
    std::vector<WebSocket> idle;
    for (int i = 0; i < 500; ++i) {
        idle.push_back(join(viewer, "Idle"));
        ASSERT_EQ(idle.back().status(), 101) << i;
    }
    WebSocket eye = join(viewer, "Eye");
    eye.send(view_message(30));
    act({{"action", "run"}});
    ASSERT_FALSE(eye.wait_for_frame().empty());
    EXPECT_GE(watch(eye, Milliseconds(2000)).size(), 20U);
    EXPECT_EQ(as_viewer().get("/api/session").json()["people"].size(), 501U);
    for (WebSocket& one : idle) ASSERT_FALSE(one.ended());
}

TEST_F(Crowd, who_is_silent_or_slow_for_too_long_is_let_go) {
    start({}, Milliseconds(1500));
    const auto closed = [](Socket& socket) {
        while (!socket.receive(Milliseconds(10000)).empty()) {
        }
        return socket.closed();
    };
    Socket silent(port()), header(port()), body(port());
    header.send("GET /api/session HTTP/1.1\r\nHo");
    body.send(
        fmt::format("POST /api/scenarios/A/actions HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n"
                    "Content-Length: 1000\r\n\r\n{{",
                    port(), controller));
    WebSocket mute = join(viewer, "Mute"), stalled = join(viewer, "Stalled", 4096);
    stalled.send(view_message(60));
    act({{"action", "run"}});
    const auto begin = Clock::now();
    // Trickling does not help: the time is for the whole header.
    for (int i = 0; i < 20 && header.send("x"); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(closed(silent) && closed(header) && closed(body));
    while (as_viewer().get("/api/session").json()["people"].size() > 0 &&
           Clock::now() - begin < std::chrono::seconds(20)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    EXPECT_TRUE(as_viewer().get("/api/session").json()["people"].empty());
    EXPECT_LT(Clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(Crowd, who_answers_pings_may_be_silent) {
    start({}, Milliseconds(1500));
    WebSocket eye = join(viewer, "Eye");
    ASSERT_FALSE(eye.wait_for("hello").is_null());
    (void)eye.wait_for("never", Milliseconds(4000));
    EXPECT_FALSE(eye.ended());
}

TEST_F(Crowd, an_idle_session_costs_no_processor_time) {
    WebSocket eye = join(viewer, "Eye");
    eye.send(view_message(60));
    ASSERT_FALSE(eye.wait_for_frame().empty());
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const double before = processor_seconds();
    std::this_thread::sleep_for(std::chrono::seconds(2));
    EXPECT_LT(processor_seconds() - before, 0.02);
}

}  // namespace
}  // namespace talus::test
