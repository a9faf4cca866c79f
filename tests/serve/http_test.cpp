#include <algorithm>
#include <string>

#include "serve/serve_fixture.hpp"

namespace talus::test {
namespace {

class Http : public Serve {
  protected:
    /// Status of `GET target` with exactly these headers.
    int status(const std::string& target, const Headers& headers, const std::string& method = "GET") {
        HttpClient client(port());
        return client.ask(method, target, "", headers).status;
    }
    [[nodiscard]] std::string host() const { return fmt::format("127.0.0.1:{}", port()); }
    static std::string bearer(const char* token) { return std::string("Bearer ") + token; }
    /// What comes back for these bytes; status 0: nothing.
    Answer raw(const std::string& bytes) {
        Socket socket(port());
        socket.send(bytes);
        std::string buffer;
        return read_answer(socket, buffer);
    }
};

TEST_F(Http, reading_needs_a_token_and_changing_that_of_controllers) {
    HttpClient nobody(port()), wrong(port(), "viewer-token-of-the-testx");
    HttpClient eye = as_viewer(), hand = as_controller();
    for (const char* target :
         {"/api/session", "/api/scene", "/api/scenarios/A/state", "/api/scenarios/A/exports/front.csv"}) {
        const Answer refused = nobody.get(target);
        EXPECT_EQ(refused.status, 401) << target;
        EXPECT_NE(refused.json()["error"].get<std::string>().find("token"), std::string::npos);
        EXPECT_EQ(wrong.get(target).status, 401) << target;
        EXPECT_EQ(eye.get(target).status, 200) << target;
        EXPECT_EQ(hand.get(target).status, 200) << target;
    }
    const nlohmann::json pause = {{"action", "pause"}};
    EXPECT_EQ(nobody.post("/api/scenarios/A/actions", pause).status, 401);
    EXPECT_EQ(eye.post("/api/scenarios/A/actions", pause).status, 403);
    EXPECT_EQ(hand.post("/api/scenarios/A/actions", pause).status, 200);
    EXPECT_EQ(eye.ask("DELETE", "/api/scenarios/B").status, 403);
    EXPECT_EQ(eye.post("/api/scenarios", {{"copy_of", "A"}}).status, 403);
    EXPECT_EQ(eye.post("/api/control", {{"do", "request"}}).status, 403);
    EXPECT_EQ(nobody.get("/api/openapi.json").status, 200);
    EXPECT_EQ(nobody.get("/").status, 200);
}

TEST_F(Http, ends_while_files_are_written) {
    for (int wait = 0; wait < 200; wait += 20) {
        start();
        act({{"action", "step"}});
        Socket socket(port());
        ASSERT_TRUE(
            socket.send(fmt::format("GET /api/scenarios/A/exports/report.html HTTP/1.1\r\nHost: {}\r\n"
                                    "Authorization: Bearer {}\r\n\r\n",
                                    host(), viewer)));
        std::this_thread::sleep_for(std::chrono::milliseconds(wait));
        server_.reset();  // must neither crash nor wait for an answer that nobody gets
    }
}

TEST_F(Http, a_link_tells_no_more_than_it_entitles_to) {
    const auto eye = as_viewer().get("/api/session").json(), hand = as_controller().get("/api/session").json();
    EXPECT_EQ(eye["you"]["role"], "viewer");
    EXPECT_EQ(hand["you"]["role"], "controller");
    EXPECT_EQ(eye["links"], (nlohmann::json{{"viewer", viewer}}));
    EXPECT_EQ(hand["links"]["controller"], controller);
    EXPECT_EQ(eye.dump().find(controller), std::string::npos);
}

TEST_F(Http, only_known_hosts_and_own_pages_may_ask) {
    const std::string own = "http://" + host();
    for (const char* target : {"/", "/api/session"}) {
        EXPECT_EQ(status(target, {{"Host", host()}, {"Authorization", bearer(viewer)}}), 200);
        EXPECT_EQ(status(target, {{"Host", host()}, {"Origin", own}, {"Authorization", bearer(viewer)}}), 200);
        EXPECT_EQ(status(target, {{"Host", "twin.example.org"},
                                  {"Origin", "https://twin.example.org"},
                                  {"Authorization", bearer(viewer)}}),
                  200);
        // A name that an attacker lets resolve to this machine: origin and host agree.
        EXPECT_EQ(status(target, {{"Host", "evil.example.org"},
                                  {"Origin", "http://evil.example.org"},
                                  {"Authorization", bearer(viewer)}}),
                  403);
        for (const char* origin : {"null", "http://evil.example.org", "http://127.0.0.1:1", "https://localhost"}) {
            EXPECT_EQ(status(target, {{"Host", host()}, {"Origin", origin}, {"Authorization", bearer(viewer)}}), 403);
        }
        EXPECT_EQ(status(target, {{"Host", "127.0.0.1"}, {"Authorization", bearer(viewer)}}), 403);
        EXPECT_EQ(status(target, {{"Host", ""}, {"Authorization", bearer(viewer)}}), 403);
    }
    const std::string request = "GET / HTTP/1.1\r\nHost: " + host() + "\r\n";
    EXPECT_EQ(raw(request + "\r\n").status, 200);
    EXPECT_EQ(raw(request + "Host: " + host() + "\r\n\r\n").status, 403);
    EXPECT_EQ(raw("GET / HTTP/1.1\r\n\r\n").status, 403);
    // A page elsewhere can send this without asking first: no token, no origin.
    EXPECT_EQ(status("/api/scenarios/A/actions", {{"Host", host()}, {"Content-Type", "text/plain"}}, "POST"), 401);
    EXPECT_EQ(status("/api/scenarios/A/actions", {{"Host", host()}, {"Origin", own}}, "OPTIONS"), 405);
}

TEST_F(Http, says_what_browsers_must_not_do) {
    HttpClient client = as_viewer();
    Answer page = client.get("/");
    EXPECT_EQ(page.headers["content-type"].rfind("text/html", 0), 0U);
    const std::string policy = page.headers["content-security-policy"];
    EXPECT_NE(policy.find("default-src 'self'"), std::string::npos);
    EXPECT_NE(policy.find("script-src 'self';"), std::string::npos);
    EXPECT_NE(policy.find(fmt::format("connect-src 'self' ws://{} ", host())), std::string::npos);
    EXPECT_EQ(policy.find("unsafe"), std::string::npos);
    EXPECT_EQ(page.headers["referrer-policy"], "no-referrer");
    EXPECT_EQ(page.headers["x-content-type-options"], "nosniff");
    EXPECT_EQ(page.headers["cross-origin-opener-policy"], "same-origin");
    Answer state = client.get("/api/scenarios/A/state");
    EXPECT_EQ(state.headers["cache-control"], "no-store");
    EXPECT_EQ(state.headers["x-content-type-options"], "nosniff");
    EXPECT_NE(state.headers["content-security-policy"].find("default-src 'none'"), std::string::npos);
    EXPECT_EQ(state.headers.count("access-control-allow-origin"), 0U);
}

TEST_F(Http, unknown_routes_and_methods_are_refused) {
    HttpClient client = as_controller();
    for (const char* target : {"/api", "/api/nothing", "/api/scenarios/A", "/nothing.js", "/../server.cpp",
                               "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/api/scenarios/C/state",
                               "/api/scenarios/A/layers/nothing", "/api/scenarios/A/exports/..%2Fslope.toml"}) {
        const Answer answer = client.get(target);
        const bool other_method = std::string(target) == "/api/scenarios/A";
        EXPECT_EQ(answer.status, other_method ? 405 : 404) << target;
        EXPECT_TRUE(answer.json()["error"].is_string());
    }
    Answer wrong = client.ask("PUT", "/api/scenarios/A/actions", "{}");
    EXPECT_EQ(wrong.status, 405);
    EXPECT_EQ(wrong.headers["allow"], "POST");
    EXPECT_EQ(client.ask("POST", "/", "x").status, 405);
    const Answer head = client.ask("HEAD", "/api/scenarios/A/state");
    EXPECT_EQ(head.status, 200);
    EXPECT_TRUE(head.body.empty());
    EXPECT_EQ(client.get("/api/scenarios/A/state").status, 200);
}

TEST_F(Http, bodies_are_read_up_to_their_limit_and_checked) {
    HttpClient client = as_controller();
    const std::string actions = "/api/scenarios/A/actions";
    for (const char* body :
         {"", "{", "[]", "17", "{\"action\": 5}", "{\"action\": \"fly\"}", "{\"action\":\"set_speed\"}",
          "{\"action\":\"set_speed\",\"factor\":0.01}", "{\"action\":\"set_speed\",\"factor\":\"1\"}"}) {
        const Answer answer = client.ask("POST", actions, body);
        EXPECT_EQ(answer.status, 400) << body;
        EXPECT_TRUE(answer.json()["error"].is_string());
    }
    EXPECT_EQ(client.ask("POST", actions, std::string(1000, '[')).status, 400);
    EXPECT_EQ(client.ask("POST", actions, "{\"action\": \"pause\"" + std::string(1000000, ' ') + "}").status, 200);
    EXPECT_EQ(client.ask("POST", actions, std::string(1048577, ' ')).status, 413);
    // Refused by what it says of itself, before anything of it is there.
    EXPECT_EQ(raw("POST " + actions + " HTTP/1.1\r\nHost: " + host() + "\r\nAuthorization: " + bearer(controller) +
                  "\r\nContent-Length: 999999999999\r\n\r\n")
                  .status,
              413);
    std::string chunked = "POST " + actions + " HTTP/1.1\r\nHost: " + host() +
                          "\r\nAuthorization: " + bearer(controller) + "\r\nTransfer-Encoding: chunked\r\n\r\n";
    const std::string begin = chunked;
    EXPECT_EQ(raw(begin + "12\r\n{\"action\":\"pause\"}\r\n0\r\n\r\n").status, 200);
    for (int i = 0; i < 20; ++i) chunked += "10000\r\n" + std::string(65536, ' ') + "\r\n";
    EXPECT_EQ(raw(chunked + "0\r\n\r\n").status, 413);
}

TEST_F(Http, headers_are_read_up_to_their_limit) {
    const std::string begin =
        "GET /api/session HTTP/1.1\r\nHost: " + host() + "\r\nAuthorization: " + bearer(viewer) + "\r\n";
    EXPECT_EQ(raw(begin + "X: " + std::string(10000, 'x') + "\r\n\r\n").status, 200);
    EXPECT_EQ(raw(begin + "X: " + std::string(20000, 'x') + "\r\n\r\n").status, 431);
    EXPECT_EQ(raw("GET /" + std::string(100000, 'x')).status, 431);
    for (const char* bad :
         {"\r\n\r\n\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET / HTTP/1.1\r\nX\r\n\r\n",
          "\x16\x03\x01\x02", "POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n", "G@T / HTTP/1.1\r\n\r\n"}) {
        const int answered = raw(std::string(bad) + "\r\n\r\n").status;
        EXPECT_TRUE(answered == 400 || answered == 403) << bad << answered;
    }
    EXPECT_EQ(as_viewer().get("/api/session").status, 200);
}

TEST_F(Http, keeps_a_connection_and_answers_requests_in_order) {
    Socket socket(port());
    std::string requests, buffer;
    const std::string common = " HTTP/1.1\r\nHost: " + host() + "\r\nAuthorization: " + bearer(viewer) + "\r\n\r\n";
    for (const char* target : {"/api/session", "/api/nothing", "/api/scenarios/A/setup", "/"})
        requests += "GET " + std::string(target) + common;
    socket.send(requests);
    EXPECT_TRUE(read_answer(socket, buffer).json().contains("protocol"));
    EXPECT_EQ(read_answer(socket, buffer).status, 404);
    EXPECT_TRUE(read_answer(socket, buffer).json().contains("revision"));
    EXPECT_EQ(read_answer(socket, buffer).headers["content-type"].rfind("text/html", 0), 0U);
}

TEST_F(Http, a_client_that_leaves_before_its_answer_harms_nobody) {
    for (int i = 0; i < 50; ++i) {
        Socket socket(port());
        socket.send("GET /api/scenarios/A/layers/depth HTTP/1.1\r\nHost: " + host() +
                    "\r\nAuthorization: " + bearer(viewer) + "\r\n\r\n");
        if (i % 2 == 0) socket.kill();
    }
    EXPECT_EQ(as_viewer().get("/api/session").status, 200);
}

TEST_F(Http, a_port_in_use_is_one_clear_line) {
    serve::ServerOptions options;
    options.port = port();
    options.tokens = {controller, viewer};
    const auto second = serve::Server::listen(options);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().message,
              fmt::format("port {} is in use; choose another with --port, or --port 0 for any that is free", port()));
    options.host = "somewhere";
    options.port = 0;
    EXPECT_FALSE(serve::Server::listen(options));
}

}  // namespace
}  // namespace talus::test
