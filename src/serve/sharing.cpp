#include "serve/sharing.hpp"

#include <algorithm>
#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <cctype>
#include <chrono>
#include <ifaddrs.h>
#include <net/if.h>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::serve {
namespace {

namespace asio = boost::asio;
namespace ssl = asio::ssl;
using asio::ip::tcp;
using Code = boost::system::error_code;

constexpr std::chrono::seconds handshake_time{10}, goodbye_time{2};
constexpr std::size_t most_relayed = 256, block = 16 * 1024, longest_host = 253;

bool plain_name(const std::string& name) {
    return name.size() <= longest_host && std::all_of(name.begin(), name.end(), [](unsigned char c) {
               return std::isalnum(c) != 0 || c == '-' || c == '.';
           });
}

Result<std::shared_ptr<ssl::context>> tls_with(const ShareWanted& wanted) {
    auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
    Code error;
    context->set_options(ssl::context::default_workarounds | ssl::context::no_sslv2 | ssl::context::no_sslv3 |
                             ssl::context::no_tlsv1 | ssl::context::no_tlsv1_1,
                         error);
    context->use_certificate_chain(asio::buffer(wanted.certificate), error);
    if (error) return Error{"certificate: is not a certificate in PEM format: " + error.message()};
    // Without a callback a key with a password would be asked for at the terminal.
    context->set_password_callback([](std::size_t, ssl::context::password_purpose) { return std::string(); }, error);
    context->use_private_key(asio::buffer(wanted.key), ssl::context::pem, error);
    if (error)
        return Error{"key: is not a key in PEM format, has a password, or is not that of the certificate: " +
                     error.message()};
    if (SSL_CTX_check_private_key(context->native_handle()) != 1) {
        return Error{"key: is not that of the certificate"};
    }
    return context;
}

}  // namespace

std::vector<std::string> shareable_addresses() {
    std::vector<std::string> v4, v6;
    ifaddrs* all = nullptr;
    if (getifaddrs(&all) != 0) return {};
    for (const ifaddrs* i = all; i != nullptr; i = i->ifa_next) {
        if (i->ifa_addr == nullptr || (i->ifa_flags & IFF_UP) == 0 || (i->ifa_flags & IFF_LOOPBACK) != 0) continue;
        if (i->ifa_addr->sa_family == AF_INET) {
            const auto* address = reinterpret_cast<const sockaddr_in*>(i->ifa_addr);
            v4.push_back(asio::ip::address_v4(ntohl(address->sin_addr.s_addr)).to_string());
        } else if (i->ifa_addr->sa_family == AF_INET6) {
            const auto* address = reinterpret_cast<const sockaddr_in6*>(i->ifa_addr);
            asio::ip::address_v6::bytes_type bytes{};
            std::copy(std::begin(address->sin6_addr.s6_addr), std::end(address->sin6_addr.s6_addr), bytes.begin());
            const asio::ip::address_v6 found(bytes);
            if (!found.is_link_local()) v6.push_back(found.to_string());
        }
    }
    freeifaddrs(all);
    v4.insert(v4.end(), v6.begin(), v6.end());
    return v4;
}

/// A connection with TLS on one side and the server on the other.
class Sharing::Relay : public std::enable_shared_from_this<Relay> {
  public:
    Relay(tcp::socket socket, std::shared_ptr<ssl::context> context)
        : context_(std::move(context)),
          outer_(std::move(socket), *context_),
          inner_(outer_.get_executor()),
          timer_(outer_.get_executor()) {}

    void start(const tcp::endpoint& server, std::function<void()> on_end) {
        on_end_ = std::move(on_end);
        timer_.expires_after(handshake_time);
        timer_.async_wait([self = shared_from_this()](Code error) {
            if (!error) self->end();
        });
        outer_.async_handshake(ssl::stream_base::server, [self = shared_from_this(), server](Code error) {
            if (error) return self->end();
            self->inner_.async_connect(server, [self](Code failed) {
                self->timer_.cancel();
                if (failed) return self->end();
                pump(self, self->outer_, self->inner_, self->up_, &Relay::end);
                pump(self, self->inner_, self->outer_, self->down_, &Relay::say_goodbye);
            });
        });
    }
    void end() {
        Code ignored;
        timer_.cancel();
        outer_.lowest_layer().close(ignored);
        inner_.close(ignored);
        if (on_end_) std::exchange(on_end_, nullptr)();
    }

  private:
    using Block = std::array<char, block>;

    /// The server has closed: the other side is told, so that it knows that nothing is missing.
    void say_goodbye() {
        timer_.expires_after(goodbye_time);
        timer_.async_wait([self = shared_from_this()](Code error) {
            if (!error) self->end();
        });
        outer_.async_shutdown([self = shared_from_this()](Code) { self->end(); });
    }

    template <class From, class To>
    static void pump(const std::shared_ptr<Relay>& self, From& from, To& to, Block& bytes, void (Relay::*at_end)()) {
        from.async_read_some(asio::buffer(bytes), [self, &from, &to, &bytes, at_end](Code error, std::size_t count) {
            if (error) return (self.get()->*at_end)();
            asio::async_write(to, asio::buffer(bytes, count),
                              [self, &from, &to, &bytes, at_end](Code failed, std::size_t) {
                                  if (failed) return self->end();
                                  pump(self, from, to, bytes, at_end);
                              });
        });
    }

    std::shared_ptr<ssl::context> context_;
    ssl::stream<tcp::socket> outer_;
    tcp::socket inner_;
    asio::steady_timer timer_;
    Block up_{}, down_{};
    std::function<void()> on_end_;
};

class Sharing::Door : public std::enable_shared_from_this<Door> {
  public:
    Door(asio::io_context& io, tcp::endpoint inner, const std::function<void(tcp::socket)>& serve)
        : acceptor_(io), retry_(io), inner_(std::move(inner)), serve_(serve) {}

    Status open(const ShareWanted& wanted) {
        if (!wanted.certificate.empty() || !wanted.key.empty()) {
            TALUS_ASSIGN(tls_, tls_with(wanted));
        }
        const tcp::endpoint endpoint(asio::ip::make_address(wanted.address), wanted.port);
        Code error;
        acceptor_.open(endpoint.protocol(), error);
        if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
        if (!error) acceptor_.bind(endpoint, error);
        if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
        if (error == asio::error::address_in_use) {
            return Error{fmt::format("port = {}: is in use on {}; choose another, or 0 for any that is free",
                                     wanted.port, wanted.address)};
        }
        if (error) return Error{fmt::format("{} port {}: {}", wanted.address, wanted.port, error.message())};
        const bool v6 = endpoint.address().is_v6();
        host_ = fmt::format("{}:{}",
                            !wanted.name.empty() ? wanted.name
                            : v6                 ? "[" + wanted.address + "]"
                                                 : wanted.address,
                            acceptor_.local_endpoint(error).port());
        accept();
        return {};
    }
    void close() {
        Code ignored;
        acceptor_.close(ignored);
        retry_.cancel();
        const std::set<std::shared_ptr<Relay>> relays = std::exchange(relays_, {});
        for (const auto& relay : relays) relay->end();
    }
    [[nodiscard]] bool encrypted() const { return tls_ != nullptr; }
    [[nodiscard]] const std::string& host() const { return host_; }

  private:
    void accept() {
        acceptor_.async_accept([self = shared_from_this()](Code error, tcp::socket socket) {
            if (!self->acceptor_.is_open()) return;
            if (error) {
                // Out of files or memory: others must end first.
                self->retry_.expires_after(std::chrono::milliseconds(100));
                self->retry_.async_wait([self](Code cancelled) {
                    if (!cancelled) self->accept();
                });
                return;
            }
            if (!self->tls_) {
                self->serve_(std::move(socket));
            } else if (self->relays_.size() < most_relayed) {
                const auto relay = std::make_shared<Relay>(std::move(socket), self->tls_);
                self->relays_.insert(relay);
                relay->start(self->inner_, [self, weak = std::weak_ptr<Relay>(relay)] {
                    if (const auto ended = weak.lock()) self->relays_.erase(ended);
                });
            }
            self->accept();
        });
    }

    tcp::acceptor acceptor_;
    asio::steady_timer retry_;
    const tcp::endpoint inner_;
    const std::function<void(tcp::socket)>& serve_;
    std::shared_ptr<ssl::context> tls_;
    std::set<std::shared_ptr<Relay>> relays_;
    std::string host_;
};

Sharing::Sharing(asio::io_context& io, tcp::endpoint inner, std::function<void(tcp::socket)> serve)
    : io_(io), inner_(std::move(inner)), serve_(std::move(serve)) {}

Sharing::~Sharing() {
    close();
}

Status Sharing::open(const ShareWanted& wanted) {
    const auto addresses = shareable_addresses();
    if (std::find(addresses.begin(), addresses.end(), wanted.address) == addresses.end()) {
        return Error{fmt::format("address = \"{}\": is none of this computer that others can reach", wanted.address)};
    }
    if (!plain_name(wanted.name)) return Error{"name: has letters, digits, hyphens and dots"};
    if (door_) return Error{"it is shared already; stop that first"};
    const auto door = std::make_shared<Door>(io_, inner_, serve_);
    TALUS_TRY(door->open(wanted));
    door_ = door;
    return {};
}

void Sharing::close() {
    if (door_) door_->close();
    door_ = nullptr;
}

bool Sharing::encrypted() const {
    return door_ && door_->encrypted();
}

std::string Sharing::host() const {
    return door_ ? door_->host() : "";
}

}  // namespace talus::serve
