#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

/// HTTP and WebSocket from the client's side, on plain sockets and written apart from the server's library, so that the
/// two cannot be wrong in the same way.
namespace talus::test {

using Milliseconds = std::chrono::milliseconds;

/// A TCP connection to a port of this machine. Throws std::runtime_error where it cannot be made.
class Socket {
  public:
    /// `receive_buffer`: bytes that the system takes in for it; 0: as usual.
    /// `from`: an address of this machine.
    explicit Socket(std::uint16_t port, int receive_buffer = 0, const char* from = nullptr);
    ~Socket();
    Socket(Socket&& other) noexcept;
    Socket& operator=(Socket&& other) = delete;
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;

    /// False: the other side has gone.
    bool send(std::string_view bytes);
    /// What is there, at least a byte; empty: the other side has gone, or nothing came in time.
    std::string receive(Milliseconds limit = Milliseconds(5000));
    [[nodiscard]] bool closed() const { return closed_; }
    /// Ends it without good-bye, with what is unread.
    void kill();

  private:
    int file_ = -1;
    bool closed_ = false;
};

struct Answer {
    int status = 0;                              ///< 0: none came
    std::map<std::string, std::string> headers;  ///< names in lower case
    std::string body;

    [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(body); }
};

/// Reads one answer; `head`: one that has no body.
Answer read_answer(Socket& socket, std::string& buffer, bool head = false);

/// Is told of every answer that an HttpClient gets: method, target, answer. Empty: nobody is.
using AnswerWatcher = std::function<void(const std::string&, const std::string&, const Answer&)>;
AnswerWatcher& answer_watcher();

using Headers = std::vector<std::pair<std::string, std::string>>;

/// A client that keeps its connection.
class HttpClient {
  public:
    explicit HttpClient(std::uint16_t port, std::string token = "") : port_(port), token_(std::move(token)) {}

    /// Host is 127.0.0.1:PORT unless `headers` has one.
    Answer ask(const std::string& method, const std::string& target, const std::string& body = "",
               const Headers& headers = {});
    Answer get(const std::string& target) { return ask("GET", target); }
    Answer post(const std::string& target, const nlohmann::json& body, const std::string& person = "");

  private:
    std::uint16_t port_;
    std::string token_;
    std::optional<Socket> socket_;
    std::string buffer_;
};

/// A viewer.
class WebSocket {
  public:
    struct Message {
        bool text = false;
        std::string data;
    };
    /// `query`: "token=...&name=...".
    WebSocket(std::uint16_t port, const std::string& query, int receive_buffer = 0);

    [[nodiscard]] int status() const { return status_; }  ///< 101: it is open
    bool send(const nlohmann::json& message) { return send_frame(1, message.dump()); }
    bool send_frame(int opcode, std::string_view data);
    /// The next message; nothing: it ended, or none came in time. Answers pings.
    std::optional<Message> receive(Milliseconds limit = Milliseconds(5000));
    /// Skips messages until a text of `type` comes. A null object: none came in time.
    nlohmann::json wait_for(const std::string& type, Milliseconds limit = Milliseconds(10000));
    /// Skips messages until a frame comes; empty: none came in time.
    std::string wait_for_frame(Milliseconds limit = Milliseconds(10000));
    [[nodiscard]] bool ended() const { return ended_; }
    Socket& socket() { return socket_; }

    nlohmann::json hello;  ///< the first message, once waited for

  private:
    Socket socket_;
    std::string buffer_;
    int status_ = 0;
    bool ended_ = false;
};

/// {"type": "view", ...}
nlohmann::json view_message(double rate_hz, unsigned cap = 1000000, std::vector<std::string> scenarios = {"A"});

/// Of a frame's header.
struct FrameHeader {
    int scenario = 0;
    unsigned flags = 0;
    double time = 0;
    std::uint64_t step = 0;
    std::uint32_t ids = 0, stride = 0;
};
std::optional<FrameHeader> read_frame_header(const std::string& frame);

}  // namespace talus::test
