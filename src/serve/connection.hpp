#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <string>
#include <vector>

#include "serve/access.hpp"
#include "serve/connection_counts.hpp"
#include "serve/open_session.hpp"
#include "serve/router.hpp"
#include "serve/site.hpp"
#include "serve/tile_addresses.hpp"

/// Shared by the files for HTTP and WebSocket.
namespace talus::serve {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

/// Data that connections need for answers. One for all; outlives them.
struct ServerContext {
    Access access;
    Router router;        ///< what there is without a session
    OpenSessionPtr open;  ///< none: no scene has been chosen yet
    Site site;
    std::chrono::milliseconds patience;  ///< timeout of a silent connection, or of one that sends its header slowly
    ConnectionCounts connections;
    std::size_t people_limit = 0;         ///< WebSockets at once, at most
    std::vector<std::string> tiles = {};  ///< addresses of map tiles that the program was started with

    /// From which the page may load pictures, besides here, as " https://tile.example.org". A page that is loaded again
    /// may load from those that people have added to the session since.
    [[nodiscard]] std::string tile_origins() const {
        return origins_of(open ? open->overlays.tile_addresses() : tiles);
    }
};

inline constexpr std::size_t largest_header = 16 * 1024, largest_body = 1024 * 1024, largest_message = 64 * 1024;

using HttpRequest = http::request<http::string_body>;

/// The other side of a connection; 0.0.0.0 if it has gone.
[[nodiscard]] inline asio::ip::address address_of(const asio::ip::tcp::socket& socket) {
    beast::error_code gone;
    const auto end = socket.remote_endpoint(gone);
    return gone ? asio::ip::address() : end.address();
}

/// Serves HTTP on a new connection until it ends or becomes a WebSocket.
void serve_http(asio::ip::tcp::socket socket, ServerContext& context);

/// Continues with `request`, which requests a WebSocket to the open session and has passed all checks.
void serve_websocket(beast::tcp_stream stream, HttpRequest request, ServerContext& context, Role role,
                     const std::string& name, const std::string& former);

/// To requests about a session while there is none.
inline constexpr const char* no_session_open = "no scene is open; choose one on the start page";

}  // namespace talus::serve
