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
#include "serve/ensembles.hpp"

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

    // Connections end with `io`, and so before the objects that they use.
    ServerOptions options;
    Ensembles ensembles;
    std::optional<Session> session;
    std::optional<Exports> exports;
    std::optional<Calibrations> calibrations;
    std::optional<ServerContext> context;
    asio::io_context io{1};
    tcp::acceptor acceptor;
    asio::steady_timer retry, ticker;
    asio::executor_work_guard<asio::io_context::executor_type> guard;
    tcp::endpoint bound;
    std::thread thread;
};

Server::Parts::~Parts() {
    io.stop();
    if (thread.joinable()) thread.join();
    // Threads end while everything that they notify still exists.
    if (calibrations) calibrations->close();
    if (session) session->close();
    if (exports) exports->close();
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
            if (!error) session->tick();
        });
    };
    return made;
}

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::listen(ServerOptions options) {
    TALUS_TRY(check_tokens(options.tokens));
    auto parts = std::make_unique<Parts>();
    TALUS_TRY(parts->bind(options.host, options.port));
    parts->options = std::move(options);
    return std::unique_ptr<Server>(new Server(std::move(parts)));
}

Status Server::serve(std::shared_ptr<const scene::Scene> scene) {
    Parts& parts = *parts_;
    const ServerOptions& options = parts.options;
    TALUS_ASSIGN(parts.ensembles, Ensembles::read(options.ensembles, *scene));
    parts.session.emplace(parts.thread_of_session(), scene, options.tokens);
    const auto on_failure = options.on_failure ? options.on_failure : [](const std::string&) {};
    TALUS_TRY(parts.session->open(options.scenario, on_failure));
    parts.exports.emplace(*parts.session, options.export_folder);
    parts.calibrations.emplace(std::move(scene), options.calibration,
                               [&parts](nlohmann::json status) { parts.session->calibration(std::move(status)); });
    parts.session->calibration(parts.calibrations->describe());
    const std::size_t connections = raise_connection_limit();
    const std::size_t per_address = options.connections_per_address;
    parts.context.emplace(ServerContext{
        Access(options.tokens, bracketed(parts.bound.address()), parts.bound.port(), options.allowed_hosts),
        make_api(*parts.session, *parts.exports, parts.ensembles, *parts.calibrations), *parts.session, Site(),
        options.patience, ConnectionCounts(connections, per_address > 0 ? per_address : connections / 3),
        connections / 2});
    if (options.run) {
        parts.session->loop().post([](Scenarios& all) {
            all.act(0, {{"action", "run"}}, "", [](const Result<twin::Done>&) {});
        });
    }
    parts.accept();
    parts.thread = std::thread([&parts] {
        pthread_setname_np(pthread_self(), "server");
        parts.io.run();
    });
    return {};
}

std::uint16_t Server::port() const {
    return parts_->bound.port();
}

std::string Server::link(Role role) const {
    const Tokens& tokens = parts_->options.tokens;
    return fmt::format("http://{}:{}/#token={}", host_for_links(parts_->bound.address()), port(),
                       role == Role::controller ? tokens.controller : tokens.viewer);
}

const std::vector<Route>& Server::routes() const {
    return parts_->context->router.routes();
}

}  // namespace talus::serve
