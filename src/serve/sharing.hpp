#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace talus::serve {

/// How a session is made reachable from other computers.
struct ShareWanted {
    std::string address;           ///< of this computer, one of shareable_addresses()
    std::uint16_t port = 0;        ///< 0: any that is free
    std::string name;              ///< the name under which browsers reach it; empty: the address
    std::string certificate, key;  ///< PEM: encrypted with TLS; both empty: plain
};

/// The addresses of this computer that others can reach: those of its network interfaces, IPv4 first.
[[nodiscard]] std::vector<std::string> shareable_addresses();

/// Another door to a server that otherwise only this computer reaches. For the server's thread. Plain connections are
/// given to the server as its own; TLS ends here, and what it carries goes on to the server as a connection from this
/// computer, as with a proxy.
class Sharing {
  public:
    /// `inner`: where the server listens; `serve`: takes a plain connection.
    Sharing(boost::asio::io_context& io, boost::asio::ip::tcp::endpoint inner,
            std::function<void(boost::asio::ip::tcp::socket)> serve);
    ~Sharing();
    Sharing(const Sharing&) = delete;
    Sharing& operator=(const Sharing&) = delete;

    /// Errors: no address of this computer, a name with other characters than those of host names, a port that is in
    /// use, a certificate or key that is none or do not belong together; then it stays as it was.
    [[nodiscard]] Status open(const ShareWanted& wanted);
    /// No further connections; those that there are end with TLS, and stay without.
    void close();

    [[nodiscard]] bool is_open() const { return door_ != nullptr; }
    [[nodiscard]] bool encrypted() const;
    /// The host of links and of the header `Host`: "192.168.1.5:8124"; empty: it is not open.
    [[nodiscard]] std::string host() const;

  private:
    class Door;
    class Relay;
    boost::asio::io_context& io_;
    const boost::asio::ip::tcp::endpoint inner_;
    const std::function<void(boost::asio::ip::tcp::socket)> serve_;
    std::shared_ptr<Door> door_;
};

}  // namespace talus::serve
