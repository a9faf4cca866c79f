#include <fstream>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

#include "serve/serve_fixture.hpp"

// How much comes and in what order; never how long it takes, which says more of the machine than of the server.
namespace talus::test {
namespace {

using nlohmann::json;

std::size_t resident_bytes() {
    std::ifstream in("/proc/self/statm");
    std::size_t total = 0, resident = 0;
    in >> total >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// How often threads of this process, server and clients, have gone to sleep: each has been woken once more.
long wake_ups() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_nvcsw;
}

struct Seen {
    std::size_t frames = 0, bytes = 0;
    std::uint64_t step = 0;  ///< of the last one
};

/// Reads frames, each of a later step than the one before, until there are so many or so many bytes of them.
Seen watch(WebSocket& viewer, std::size_t frames, std::size_t bytes = 0) {
    Seen seen;
    while (seen.frames < frames || seen.bytes < bytes) {
        const std::string frame = viewer.wait_for_frame();
        const auto header = read_frame_header(frame);
        EXPECT_TRUE(header) << "after " << seen.frames << " frames";
        if (!header) break;
        if (seen.frames > 0) {
            EXPECT_GT(header->step, seen.step);
        }
        seen = {seen.frames + 1, seen.bytes + frame.size(), header->step};
    }
    return seen;
}

class Crowd : public Serve {
  protected:
    /// Frames that soon fill a buffer, and steps that leave time for them on a busy machine.
    void SetUp() override { start({"solver.particle_spacing_m=0.4"}); }
};

TEST_F(Crowd, a_slow_viewer_slows_nobody_and_costs_no_memory) {
    constexpr std::size_t taken_in = 1'500'000;  // by the system for one viewer, at most
    WebSocket fast = join(viewer, "Fast");
    fast.send(view_message(60));
    act({{"action", "run"}});
    ASSERT_FALSE(fast.wait_for_frame().empty());

    std::vector<WebSocket> slow;
    for (int i = 0; i < 5; ++i) {
        slow.push_back(join(viewer, "Slow", 8192));
        slow.back().send(view_message(60));
    }
    watch(fast, 1, taken_in);  // as much was meant for them: their buffers are full
    [[maybe_unused]] const std::size_t memory = resident_bytes();
    const Seen beside = watch(fast, 60, taken_in);
    EXPECT_GE(beside.frames, 60U) << "beside viewers that read nothing";
#ifndef __SANITIZE_ADDRESS__  // which keeps what is freed for a while
    EXPECT_LT(static_cast<double>(resident_bytes()), static_cast<double>(memory) + 8e6);
#endif

    // The newest frame wins: once it reads again, a slow viewer is at the present after what the system had taken in.
    std::size_t bytes = 0;
    for (std::uint64_t step = 0; step < beside.step && bytes < taken_in;) {
        const std::string frame = slow[0].wait_for_frame();
        const auto header = read_frame_header(frame);
        ASSERT_TRUE(header);
        bytes += frame.size();
        step = header->step;
    }
    EXPECT_LT(bytes, taken_in);
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
    watch(eye, 40);
    EXPECT_EQ(as_viewer().get("/api/session").json()["people"].size(), 501U);
    for (WebSocket& one : idle) ASSERT_FALSE(one.ended());
}

/// The names of those who are there.
std::vector<std::string> people_of(HttpClient client) {
    std::vector<std::string> names;
    const json session = client.get("/api/session").json();
    for (const json& person : session["people"]) names.push_back(person["name"]);
    return names;
}

TEST_F(Crowd, one_address_cannot_take_all_connections) {
    connections_per_address_ = 20;
    start();
    const auto answered = [&](Socket& socket) {
        socket.send(fmt::format("GET /api/openapi.json HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", port()));
        std::string buffer;
        return read_answer(socket, buffer).status == 200;
    };
    std::vector<Socket> idle;
    for (int i = 0; i < 100; ++i) idle.emplace_back(port());
    Socket late(port()), other(port(), 0, "127.0.0.2");
    EXPECT_FALSE(answered(late)) << "the address has its share";
    EXPECT_TRUE(answered(other));
    EXPECT_TRUE(answered(idle.front())) << "those before it stay";
    idle.clear();
    bool again = false;
    for (int k = 0; k < 100 && !again; ++k) {
        Socket fresh(port());
        again = answered(fresh);
    }
    EXPECT_TRUE(again) << "connections that have ended count no more";
}

TEST_F(Crowd, who_is_silent_or_slow_for_too_long_is_let_go_and_nobody_else) {
    start({}, Milliseconds(2000));
    const auto closed = [](Socket& socket) {
        while (!socket.receive(Milliseconds(20000)).empty()) {
        }
        return socket.closed();
    };
    Socket silent(port()), header(port()), body(port());
    header.send("GET /api/session HTTP/1.1\r\nHo");
    body.send(
        fmt::format("POST /api/scenarios/A/actions HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n"
                    "Content-Length: 1000\r\n\r\n{{",
                    port(), controller));
    // Says nothing, but answers when it is asked whether it is still there.
    WebSocket eye = join(viewer, "Eye");
    WebSocket mute = join(viewer, "Mute"), stalled = join(viewer, "Stalled", 4096);
    stalled.send(view_message(60));
    act({{"action", "run"}});
    // Trickling does not help: the time is for the whole header, which would take longer than anybody waits.
    constexpr int whole_header = 600;
    int trickled = 0;
    std::vector<std::string> people{"Eye", "Mute", "Stalled"};
    for (; trickled < whole_header && (people.size() > 1 || !header.closed()); ++trickled) {
        if (!header.closed() && !header.send("x")) {
            EXPECT_TRUE(closed(header));
        }
        (void)eye.wait_for("never", Milliseconds(100));
        people = people_of(as_viewer());
    }
    EXPECT_LT(trickled, whole_header);
    EXPECT_TRUE(closed(silent) && closed(header) && closed(body));
    EXPECT_EQ(people, std::vector<std::string>{"Eye"});
    EXPECT_FALSE(eye.ended());
}

TEST_F(Crowd, an_idle_session_wakes_nobody) {
    WebSocket eye = join(viewer, "Eye");
    eye.send(view_message(60));
    ASSERT_FALSE(eye.wait_for_frame().empty());
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const long before = wake_ups();
    std::this_thread::sleep_for(std::chrono::seconds(2));
    EXPECT_LT(wake_ups() - before, 20) << "in 2 s";
}

}  // namespace
}  // namespace talus::test
