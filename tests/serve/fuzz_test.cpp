#include <random>

#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

/// Cuts, doubles, flips and inserts, the same each time.
class Mutator {
  public:
    explicit Mutator(unsigned seed) : random_(seed) {}

    std::string change(std::string bytes) {
        for (int i = below(4) + 1; i > 0 && !bytes.empty(); --i) {
            const std::size_t at = static_cast<std::size_t>(below(static_cast<int>(bytes.size())));
            switch (below(6)) {
                case 0:
                    bytes[at] = static_cast<char>(below(256));
                    break;
                case 1:
                    bytes.insert(at, static_cast<std::size_t>(below(40)), static_cast<char>(below(256)));
                    break;
                case 2:
                    bytes.erase(at, static_cast<std::size_t>(below(20)));
                    break;
                case 3:
                    bytes.resize(at);
                    break;
                case 4:
                    bytes.insert(at, bytes.substr(at / 2, static_cast<std::size_t>(below(200))));
                    break;
                default:
                    bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
            }
        }
        return bytes;
    }
    int below(int limit) { return std::uniform_int_distribution<int>(0, limit - 1)(random_); }

  private:
    std::mt19937 random_;
};

class Fuzz : public Serve {
  protected:
    void expect_good_service() {
        HttpClient client = as_controller();
        ASSERT_EQ(client.get("/api/scenarios/A/state").status, 200);
        WebSocket eye = join(viewer);
        eye.send(view_message(30));
        ASSERT_FALSE(eye.wait_for_frame().empty());
    }
};

TEST_F(Fuzz, thousands_of_mutated_requests) {
    const std::string common =
        fmt::format(" HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n", port(), controller);
    const auto post = [&](const std::string& target, const std::string& body) {
        return "POST " + target + common + fmt::format("Content-Length: {}\r\n\r\n", body.size()) + body;
    };
    const std::string requests[] = {
        "GET /api/session" + common + "\r\n",
        "GET /api/scenarios/A/probe?x_m=824200&y_m=825100" + common + "\r\n",
        "GET /api/scenarios/A/frame?time_s=0.1" + common + "\r\n",
        "GET /api/terrain?max_cells=1000" + common + "Accept-Encoding: gzip\r\nConnection: close\r\n\r\n",
        "GET /" + common + "If-None-Match: x\r\n\r\n",
        post("/api/scenarios/A/actions",
             R"({"action": "set_parameter", "key": "material.friction_coefficient", "value": 0.3})"),
        post(
            "/api/scenarios/A/actions",
            R"({"action": "put_barrier", "line": [[824180, 825090], [824180, 825110]], "height_m": 2, "thickness_m": 1})"),
        post(
            "/api/scenarios/A/actions",
            R"({"action": "put_release", "polygon": [[824180, 825090], [824190, 825090], [824185, 825099]], "thickness_m": 0.1})"),
        post("/api/control", R"({"do": "request", "secret": "p1"})"),
        "POST /api/scenarios/A/actions" + common +
            "Transfer-Encoding: chunked\r\n\r\n12\r\n{\"action\":\"pause\"}\r\n0\r\n\r\n",
    };
    Mutator mutator(5);
    for (int i = 0; i < 3000; ++i) {
        Socket socket(port());
        socket.send(mutator.change(requests[static_cast<std::size_t>(i) % std::size(requests)]));
        if (i % 10 == 0) (void)socket.receive(Milliseconds(5));
        if (i % 3 == 0) socket.kill();
    }
    expect_good_service();
}

TEST_F(Fuzz, thousands_of_mutated_messages) {
    const std::string messages[] = {view_message(30).dump(), R"({"type": "mark", "at": [1.5, -2e3, 3]})",
                                    R"({"type": "mark", "at": null})", R"({"type": "name", "name": "Bo"})",
                                    view_message(60, 1000, {"A", "B"}).dump()};
    Mutator mutator(6);
    for (int i = 0; i < 2000; ++i) {
        WebSocket eye = join(viewer, "Fuzz");
        ASSERT_EQ(eye.status(), 101) << i;
        const std::string message = mutator.change(messages[static_cast<std::size_t>(i) % std::size(messages)]);
        if (i % 2 == 0) {
            eye.send_frame(1, message);
        } else {
            // The frame itself: opcodes, lengths, masks.
            std::string frame{'\x81', static_cast<char>(0x80 | std::min<std::size_t>(message.size(), 125)), 1, 2, 3, 4};
            eye.socket().send(mutator.change(frame + message));
        }
        if (i % 20 == 0) (void)eye.receive(Milliseconds(5));
        if (i % 3 == 0) eye.socket().kill();
    }
    expect_good_service();
}

}  // namespace
}  // namespace talus::test
