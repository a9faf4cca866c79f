#include "serve/webhook.hpp"

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <charconv>
#include <openssl/ssl.h>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::serve {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using std::chrono::steady_clock;

constexpr std::size_t longest_answer = 64 * 1024;

/// One exchange, on the thread that calls it.
class Exchange {
  public:
    Exchange(const WebhookTarget& target, std::chrono::milliseconds limit, const std::function<bool()>& stop)
        : target_(target), limit_(limit), stop_(stop) {}

    Status post(const std::string& body);

  private:
    /// Starts something asynchronous, which calls `done(error)`, and waits for it. After an error nothing may run any
    /// more: what took too long still refers to what it was given.
    template <class Start>
    Status wait(const char* what, const Start& start);
    template <class Stream>
    Status exchange(Stream& stream, const std::string& body);
    Status connect(tcp::socket& socket);

    const WebhookTarget& target_;
    std::chrono::milliseconds limit_;
    const std::function<bool()>& stop_;
    asio::io_context io_;
};

template <class Start>
Status Exchange::wait(const char* what, const Start& start) {
    std::optional<boost::system::error_code> result;
    start([&result](boost::system::error_code error) { result = error; });
    const auto end = steady_clock::now() + limit_;
    io_.restart();
    while (!result && steady_clock::now() < end && !stop_()) io_.run_for(std::chrono::milliseconds(100));
    if (!result) return Error{fmt::format("{}: {} took too long", target_.shown(), what)};
    if (*result) return Error{fmt::format("{}: {}: {}", target_.shown(), what, result->message())};
    return {};
}

Status Exchange::connect(tcp::socket& socket) {
    tcp::resolver resolver(io_);
    tcp::resolver::results_type found;
    TALUS_TRY(wait("finding the host", [&](auto done) {
        resolver.async_resolve(target_.host, target_.port, [&found, done](auto error, const auto& results) {
            found = results;
            done(error);
        });
    }));
    return wait("connecting", [&](auto done) {
        asio::async_connect(socket, found, [done](auto error, const tcp::endpoint&) { done(error); });
    });
}

template <class Stream>
Status Exchange::exchange(Stream& stream, const std::string& body) {
    http::request<http::string_body> request{http::verb::post, target_.path, 11};
    const bool usual = target_.port == (target_.tls ? "443" : "80");
    request.set(http::field::host, usual ? target_.host : target_.shown());
    request.set(http::field::user_agent, "talus");
    request.set(http::field::content_type, "application/json");
    if (!target_.authorization.empty()) request.set(http::field::authorization, target_.authorization);
    request.body() = body;
    request.prepare_payload();
    TALUS_TRY(wait("sending", [&](auto done) {
        http::async_write(stream, request, [done](auto error, std::size_t) { done(error); });
    }));
    beast::flat_buffer buffer(longest_answer);
    http::response_parser<http::string_body> parser;
    parser.body_limit(longest_answer);
    TALUS_TRY(wait("the answer", [&](auto done) {
        http::async_read_header(stream, buffer, parser, [done](auto error, std::size_t) { done(error); });
    }));
    const unsigned status = parser.get().result_int();
    if (status >= 200 && status < 300) return {};
    return Error{fmt::format("{}: answered with status {}", target_.shown(), status)};
}

Status Exchange::post(const std::string& body) {
    if (!target_.tls) {
        tcp::socket socket(io_);
        TALUS_TRY(connect(socket));
        return exchange(socket, body);
    }
    asio::ssl::context context(asio::ssl::context::tls_client);
    boost::system::error_code error;
    context.set_default_verify_paths(error);
    asio::ssl::stream<tcp::socket> stream(io_, context);
    stream.set_verify_mode(asio::ssl::verify_peer, error);
    stream.set_verify_callback(asio::ssl::host_name_verification(target_.host), error);
    SSL_set_min_proto_version(stream.native_handle(), TLS1_2_VERSION);
    // A macro with a cast of its own.
    SSL_ctrl(stream.native_handle(), SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name,
             const_cast<char*>(target_.host.c_str()));
    TALUS_TRY(connect(stream.next_layer()));
    Status sent =
        wait("the certificate", [&](auto done) { stream.async_handshake(asio::ssl::stream_base::client, done); });
    if (sent) sent = exchange(stream, body);
    return sent;
}

}  // namespace

Result<WebhookTarget> read_webhook(const std::string& text) {
    WebhookTarget target;
    const std::size_t line = text.find('\n');
    std::string address = text.substr(0, line);
    std::string rest = line == std::string::npos ? "" : text.substr(line + 1);
    const auto trim = [](std::string& part) {
        const std::size_t end = part.find_last_not_of(" \t\r\n");
        part.erase(end == std::string::npos ? 0 : end + 1);
    };
    trim(address);
    trim(rest);
    const auto plain = [](const std::string& part, unsigned lowest) {
        return std::all_of(part.begin(), part.end(), [&](unsigned char c) { return c >= lowest && c < 0x7f; });
    };
    target.tls = address.starts_with("https://");
    if (!target.tls && !address.starts_with("http://"))
        return Error{"its first line must begin with https:// or http://"};
    if (!plain(address, 0x21) || !plain(rest, 0x20)) {
        return Error{"must be an address, and on a second line the value of the header Authorization if there is one"};
    }
    address.erase(0, target.tls ? 8 : 7);
    const std::size_t slash = address.find('/');
    target.path = slash == std::string::npos ? "/" : address.substr(slash);
    std::string host = address.substr(0, slash);
    if (host.find('@') != std::string::npos) return Error{"a name in the address is not supported; use a second line"};
    const std::size_t colon = host.rfind(':');
    const bool has_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
    target.port = has_port ? host.substr(colon + 1) : target.tls ? "443" : "80";
    if (has_port) host.erase(colon);
    if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
    target.host = host;
    unsigned port = 0;
    const char* const end = target.port.data() + target.port.size();
    const auto read = std::from_chars(target.port.data(), end, port);
    const bool usable = read.ec == std::errc() && read.ptr == end && port >= 1 && port <= 65535;
    if (host.empty() || !usable) {
        return Error{"its address must be http(s)://HOST[:PORT]/PATH, with a port of 1 to 65535"};
    }
    target.port = std::to_string(port);
    target.authorization = rest;
    return target;
}

Status post_webhook(const WebhookTarget& target, const std::string& body, std::chrono::milliseconds limit,
                    const std::function<bool()>& stop) {
    Exchange exchange(target, limit, stop);
    return exchange.post(body);
}

}  // namespace talus::serve
