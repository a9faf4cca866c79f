#include "serve/client.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <poll.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace talus::test {
namespace {

using Clock = std::chrono::steady_clock;

Milliseconds left_until(Clock::time_point end) {
    return std::max(Milliseconds(0), std::chrono::duration_cast<Milliseconds>(end - Clock::now()));
}

template <class T>
T read_number(const std::string& bytes, std::size_t offset) {
    T value{};
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

}  // namespace

Socket::Socket(std::uint16_t port, int receive_buffer, const char* from) : file_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0) setsockopt(file_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    if (from != nullptr) {
        address.sin_addr.s_addr = inet_addr(from);
        (void)::bind(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    }
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (file_ < 0 || ::connect(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        throw std::runtime_error(std::string("cannot connect: ") + std::strerror(errno));
    }
}

Socket::Socket(Socket&& other) noexcept : file_(std::exchange(other.file_, -1)), closed_(other.closed_) {}

Socket::~Socket() {
    if (file_ >= 0) ::close(file_);
}

void Socket::kill() {
    const linger at_once{1, 0};
    setsockopt(file_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::close(std::exchange(file_, -1));
    closed_ = true;
}

bool Socket::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
}

std::string Socket::receive(Milliseconds limit) {
    pollfd waiting{file_, POLLIN, 0};
    if (closed_ || ::poll(&waiting, 1, static_cast<int>(limit.count())) <= 0) return {};
    std::string bytes(256 * 1024, '\0');
    const ssize_t got = ::recv(file_, bytes.data(), bytes.size(), 0);
    if (got <= 0) {
        closed_ = true;
        return {};
    }
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
}

Answer read_answer(Socket& socket, std::string& buffer, bool head) {
    Answer answer;
    const auto more = [&] {
        const std::string bytes = socket.receive(Milliseconds(20000));
        buffer += bytes;
        return !bytes.empty();
    };
    std::size_t end = 0;
    while ((end = buffer.find("\r\n\r\n")) == std::string::npos) {
        if (!more()) return answer;
    }
    const std::string top = buffer.substr(0, end + 2);
    buffer.erase(0, end + 4);
    if (top.rfind("HTTP/1.1 ", 0) != 0) return answer;
    const int status = std::atoi(top.c_str() + 9);
    for (std::size_t at = top.find("\r\n") + 2; at < top.size();) {
        const std::size_t line_end = top.find("\r\n", at), colon = top.find(':', at);
        std::string name = top.substr(at, colon - at);
        std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
        answer.headers[name] = top.substr(colon + 2, line_end - colon - 2);
        at = line_end + 2;
    }
    const std::size_t length =
        answer.headers.count("content-length") ? std::stoul(answer.headers["content-length"]) : 0;
    if (!head && status != 101) {
        while (buffer.size() < length) {
            if (!more()) return answer;
        }
        answer.body = buffer.substr(0, length);
        buffer.erase(0, length);
    }
    answer.status = status;
    return answer;
}

AnswerWatcher& answer_watcher() {
    static AnswerWatcher watcher;
    return watcher;
}

Answer HttpClient::ask(const std::string& method, const std::string& target, const std::string& body,
                       const Headers& headers) {
    std::string text = method + " " + target + " HTTP/1.1\r\n";
    bool host = false;
    for (const auto& [name, value] : headers) {
        host = host || name == "Host";
        text += name + ": " + value + "\r\n";
    }
    if (!host) text += "Host: 127.0.0.1:" + std::to_string(port_) + "\r\n";
    if (!token_.empty()) text += "Authorization: Bearer " + token_ + "\r\n";
    if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
    text += "\r\n" + body;
    for (int attempt = 0; attempt < 2; ++attempt) {
        const bool fresh = !socket_;
        if (fresh) {
            socket_.emplace(port_);
            buffer_.clear();
        }
        socket_->send(text);
        Answer answer = read_answer(*socket_, buffer_, method == "HEAD");
        if (answer.status == 0 || answer.headers["connection"] == "close") socket_.reset();
        if (answer.status == 0 && !fresh) continue;
        if (answer_watcher() && answer.status != 0) answer_watcher()(method, target, answer);
        return answer;
    }
    return {};
}

Answer HttpClient::post(const std::string& target, const nlohmann::json& body, const std::string& person) {
    Headers headers{{"Content-Type", "application/json"}};
    if (!person.empty()) headers.emplace_back("Talus-Person", person);
    return ask("POST", target, body.dump(), headers);
}

WebSocket::WebSocket(std::uint16_t port, const std::string& query, int receive_buffer) : socket_(port, receive_buffer) {
    socket_.send("GET /ws?" + query + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                 "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                 "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    status_ = read_answer(socket_, buffer_).status;
    ended_ = status_ != 101;
}

bool WebSocket::send_frame(int opcode, std::string_view data) {
    std::string frame(1, static_cast<char>(0x80 | opcode));
    if (data.size() < 126) {
        frame += static_cast<char>(0x80 | data.size());
    } else if (data.size() < 65536) {
        frame += static_cast<char>(0x80 | 126);
        frame += static_cast<char>(data.size() >> 8);
        frame += static_cast<char>(data.size() & 255);
    } else {
        frame += static_cast<char>(0x80 | 127);
        for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>((data.size() >> shift) & 255);
    }
    const char mask[4] = {0x12, 0x34, 0x56, 0x78};
    frame.append(mask, 4);
    for (std::size_t i = 0; i < data.size(); ++i) frame += static_cast<char>(data[i] ^ mask[i % 4]);
    return socket_.send(frame);
}

std::optional<WebSocket::Message> WebSocket::receive(Milliseconds limit) {
    const auto end = Clock::now() + limit;
    while (!ended_) {
        if (buffer_.size() >= 2) {
            const int opcode = buffer_[0] & 15;
            std::uint64_t size = static_cast<unsigned char>(buffer_[1]);
            std::size_t header = 2;
            const auto number = [&](std::size_t bytes) {
                size = 0;
                header += bytes;
                for (std::size_t i = 0; i < bytes && buffer_.size() >= header; ++i) {
                    size = size << 8 | static_cast<unsigned char>(buffer_[2 + i]);
                }
            };
            if (size == 126)
                number(2);
            else if (size == 127)
                number(8);
            if (buffer_.size() >= header && buffer_.size() - header >= size) {
                Message message{opcode == 1, buffer_.substr(header, size)};
                buffer_.erase(0, header + size);
                if (opcode == 1 || opcode == 2) return message;
                if (opcode == 9) send_frame(10, message.data);
                if (opcode == 8) {
                    send_frame(8, message.data);
                    ended_ = true;
                }
                continue;
            }
        }
        const auto left = left_until(end);
        const std::string bytes = socket_.receive(left);
        buffer_ += bytes;
        if (bytes.empty()) {
            ended_ = ended_ || socket_.closed();
            if (ended_ || left.count() == 0) return {};
        }
    }
    return {};
}

nlohmann::json WebSocket::wait_for(const std::string& type, Milliseconds limit) {
    const auto end = Clock::now() + limit;
    while (auto message = receive(left_until(end))) {
        if (!message->text) continue;
        nlohmann::json content = nlohmann::json::parse(message->data);
        if (content["type"] == "hello") hello = content;
        if (content["type"] == type) return content;
    }
    return {};
}

std::string WebSocket::wait_for_frame(Milliseconds limit) {
    const auto end = Clock::now() + limit;
    while (auto message = receive(left_until(end))) {
        if (!message->text) return message->data;
    }
    return {};
}

nlohmann::json view_message(double rate_hz, unsigned cap, std::vector<std::string> scenarios) {
    return {{"type", "view"}, {"scenarios", std::move(scenarios)}, {"rate_hz", rate_hz}, {"particle_cap", cap}};
}

std::optional<FrameHeader> read_frame_header(const std::string& frame) {
    if (frame.size() < 88 || frame.compare(0, 4, "TLSF") != 0 || frame[4] != 1) return {};
    FrameHeader header;
    header.scenario = frame[5];
    header.flags = read_number<std::uint16_t>(frame, 6);
    header.time = read_number<double>(frame, 8);
    header.step = read_number<std::uint64_t>(frame, 16);
    header.ids = read_number<std::uint32_t>(frame, 24);
    header.stride = read_number<std::uint32_t>(frame, 28);
    return header;
}

}  // namespace talus::test
