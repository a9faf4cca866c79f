#include "serve/server.hpp"

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <optional>
#include <pthread.h>
#include <sys/resource.h>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/api.hpp"
#include "serve/connection.hpp"
#include "serve/executor.hpp"
#include "serve/open_session.hpp"
#include "serve/sharing.hpp"
#include "serve/start.hpp"
#include "serve/tile_addresses.hpp"

namespace talus::serve {
namespace {

using asio::ip::tcp;

constexpr rlim_t wanted_files = 8192;
constexpr std::size_t spare_files = 64;  // for everything but connections

/// Raises the number of open connections of this process to the system's limit; returns it.
std::size_t raise_connection_limit() {
    rlimit files{};
    if (getrlimit(RLIMIT_NOFILE, &files) != 0) return 256;
    if (files.rlim_cur < wanted_files) {
        files.rlim_cur = files.rlim_max == RLIM_INFINITY ? wanted_files : std::min(files.rlim_max, wanted_files);
        setrlimit(RLIMIT_NOFILE, &files);
        getrlimit(RLIMIT_NOFILE, &files);
    }
    const auto most = static_cast<std::size_t>(std::min(files.rlim_cur, wanted_files));
    return most > 2 * spare_files ? most - spare_files : most / 2;
}

std::string bracketed(const asio::ip::address& address) {
    return address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
}

/// An address that a browser on this machine can open.
std::string host_for_links(const asio::ip::address& address) {
    return address.is_unspecified() ? "127.0.0.1" : bracketed(address);
}

}  // namespace

struct Server::Parts {
    Parts() : acceptor(io), retry(io), ticker(io), guard(asio::make_work_guard(io)) {}
    ~Parts();

    [[nodiscard]] Status bind(const std::string& host, std::uint16_t port);
    void accept();
    [[nodiscard]] Thread thread_of_session();
    void listen_for(OpenSessionPtr open);

    Executor executor;
    // Connections end with `io`, and so before the objects that they use.
    ServerOptions options;
    std::optional<Start> start;
    std::optional<ServerContext> context;
    asio::io_context io{1};
    std::optional<Sharing> sharing;
    tcp::acceptor acceptor;
    asio::steady_timer retry, ticker;
    asio::executor_work_guard<asio::io_context::executor_type> guard;
    tcp::endpoint bound;
    std::thread thread;
};

Server::Parts::~Parts() {
    io.stop();
    if (thread.joinable()) thread.join();
    if (start) start->close();
    if (context && context->open) context->open->close();
}

Status Server::Parts::bind(const std::string& host, std::uint16_t port) {
    boost::system::error_code error;
    const auto address = asio::ip::make_address(host == "localhost" ? "127.0.0.1" : host, error);
    if (error) return Error{fmt::format("--host {}: not an address; for example 127.0.0.1, 0.0.0.0 or ::1", host)};
    const tcp::endpoint endpoint(address, port);
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use) {
        return Error{
            fmt::format("port {} is in use; choose another with --port, or --port 0 for any that is free", port)};
    }
    if (error == asio::error::access_denied) {
        return Error{
            fmt::format("port {} needs more rights than this program has; choose one above 1023 with --port", port)};
    }
    if (error) return Error{fmt::format("cannot listen on {} port {}: {}", host, port, error.message())};
    bound = acceptor.local_endpoint(error);
    return {};
}

void Server::Parts::accept() {
    acceptor.async_accept([this](boost::system::error_code error, tcp::socket socket) {
        if (error == asio::error::operation_aborted) return;
        if (error) {
            // Out of files or memory: others must end first.
            retry.expires_after(std::chrono::milliseconds(100));
            retry.async_wait([this](boost::system::error_code) { accept(); });
            return;
        }
        if (context->connections.has_room(address_of(socket))) serve_http(std::move(socket), *context);
        accept();
    });
}

Thread Server::Parts::thread_of_session() {
    Thread made;
    made.post = [this](std::function<void()> task) { asio::post(io, std::move(task)); };
    made.tick_after = [this](std::chrono::milliseconds wait) {
        ticker.expires_after(wait);
        ticker.async_wait([this](boost::system::error_code error) {
            if (!error && context->open) context->open->session.tick();
        });
    };
    return made;
}

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::listen(ServerOptions options) {
    TALUS_TRY(check_tokens(options.tokens));
    for (const std::string& address : options.tiles) TALUS_TRY(check_tile_address(address));
    auto parts = std::make_unique<Parts>();
    TALUS_TRY(parts->bind(options.host, options.port));
    parts->options = std::move(options);
    return std::unique_ptr<Server>(new Server(std::move(parts)));
}

Status Server::serve(const std::shared_ptr<const scene::Scene>& scene) {
    Parts& parts = *parts_;
    TALUS_ASSIGN(auto open, OpenSession::open(parts.thread_of_session(), parts.executor, scene, parts.options));
    parts.listen_for(std::move(open));
    return {};
}

void Server::start(StartSettings settings) {
    Parts& parts = *parts_;
    parts.options.reader = settings.reader;
    const std::filesystem::path file = settings.file;
    parts.start.emplace(std::move(settings), parts.options,
                        Start::Host{parts.thread_of_session(), parts.executor, [&parts] { return parts.context->open; },
                                    [&parts](OpenSessionPtr open) { parts.context->open = std::move(open); }});
    if (!file.empty()) {
        asio::post(parts.io, [&parts, file] { parts.start->open_file(file); });
    }
    parts.listen_for(nullptr);
}

void Server::Parts::listen_for(OpenSessionPtr open) {
    const std::size_t connections = raise_connection_limit();
    const std::size_t per_address = options.connections_per_address;
    context.emplace(
        ServerContext{Access(options.tokens, bracketed(bound.address()), bound.port(), options.allowed_hosts),
                      make_start_api(start ? &*start : nullptr), std::move(open), Site(), options.patience,
                      ConnectionCounts(connections, per_address > 0 ? per_address : connections / 3), connections / 2,
                      options.tiles});
    const auto inner =
        bound.address().is_unspecified() ? tcp::endpoint(asio::ip::address_v4::loopback(), bound.port()) : bound;
    sharing.emplace(io, inner, [this](tcp::socket socket) {
        if (context->connections.has_room(address_of(socket))) serve_http(std::move(socket), *context);
    });
    add_share_routes(context->router, *sharing, context->access);
    accept();
    thread = std::thread([this] {
        pthread_setname_np(pthread_self(), "server");
        io.run();
    });
}

std::uint16_t Server::port() const {
    return parts_->bound.port();
}

std::string Server::link(Role role) const {
    const Tokens& tokens = parts_->options.tokens;
    return fmt::format("http://{}:{}/#token={}", host_for_links(parts_->bound.address()), port(),
                       role == Role::controller ? tokens.controller : tokens.viewer);
}

std::vector<Route> Server::routes() const {
    std::vector<Route> all = parts_->context->router.routes();
    if (parts_->context->open) {
        const std::vector<Route>& more = parts_->context->open->router.routes();
        all.insert(all.end(), more.begin(), more.end());
    }
    return all;
}

}  // namespace talus::serve
