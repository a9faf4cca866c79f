#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "serve/answer_headers.hpp"
#include "serve/connection.hpp"
#include "serve/request_checks.hpp"
#include "session/url.hpp"

namespace talus::serve {
namespace {

using std::chrono::seconds;

constexpr const char* another_scene = "another scene has been opened; reload the page";
constexpr std::size_t slowest_reader = 16 * 1024;  // bytes per second
constexpr seconds linger_time{2};
const std::vector<std::string> websocket_keys = {"token", "name", "person"};
constexpr std::size_t piece_size = 256 * 1024;
constexpr std::size_t linger_bytes = 8 * 1024 * 1024;

std::string text_of(beast::string_view text) {
    return std::string(text.data(), text.size());
}

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
  public:
    HttpConnection(asio::ip::tcp::socket socket, ServerContext& context)
        : context_(context), count_(context.connections, address_of(socket)), stream_(std::move(socket)) {}

    void read_header();

  private:
    void on_header(beast::error_code error);
    void read_body();
    void begin_intake();
    void read_piece();
    void on_piece(beast::error_code error);
    void on_error(beast::error_code error);
    /// The answer to a request that is refused by its header; empty: continue.
    std::optional<Response> refusal();
    void handle();
    /// Another scene may be put in the place of the one that was asked while the body comes.
    [[nodiscard]] bool asked_is_closed() const { return asked_ && asked_ != context_.open; }
    /// Lets go of an intake, and does not read the rest of the body.
    void end_intake(Response response);
    /// What another thread has until it answers. That thread releases the connection, so that it always ends on this
    /// one; so it does if the answer never comes, because a session was closed with requests that waited.
    struct Held {
        explicit Held(std::shared_ptr<HttpConnection> waiting) : connection(std::move(waiting)) {}
        ~Held() {
            if (!connection) return;
            const auto executor = connection->stream_.get_executor();
            asio::post(executor, [ended = std::move(connection)] {});
        }
        Held(const Held&) = delete;
        Held& operator=(const Held&) = delete;
        std::shared_ptr<HttpConnection> connection;
    };
    /// For answers that may come from another thread, and after the client has gone.
    Respond respond_later();
    void upgrade();
    void give_file();
    void respond(Response response);
    void write(http::response<http::span_body<const char>> message);
    void on_written(beast::error_code error);
    void linger();
    [[nodiscard]] std::uint64_t body_limit() const {
        return route_ != nullptr && route_->largest_body > 0 ? route_->largest_body : largest_body;
    }
    [[nodiscard]] std::string header(http::field name) const { return text_of(parser_->get()[name]); }

    ServerContext& context_;
    ConnectionCounts::Counted count_;
    beast::tcp_stream stream_;
    beast::flat_buffer buffer_{64 * 1024};
    std::optional<http::request_parser<http::string_body>> parser_;
    Request request_;
    const Route* route_ = nullptr;
    OpenSessionPtr asked_;  // the session that route_ belongs to
    // Of a body that is taken piece by piece.
    std::optional<http::request_parser<http::buffer_body>> pieces_;
    std::shared_ptr<Intake> intake_;
    std::string piece_;
    // Of the answer that is being written.
    Bytes body_;
    std::function<void()> then_;  // once it is
    std::optional<http::response<http::span_body<const char>>> message_;
    bool close_ = false;
    std::size_t drained_ = 0;
};

void HttpConnection::read_header() {
    parser_.emplace();
    parser_->header_limit(largest_header);
    // The limit depends on the route, and is set before anything of the body is read.
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
    request_ = {};
    route_ = nullptr;
    pieces_.reset();
    intake_ = nullptr;
    asked_ = nullptr;
    close_ = false;
    stream_.expires_after(context_.patience);
    http::async_read_header(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_header(error); });
}

void HttpConnection::on_error(beast::error_code error) {
    close_ = true;
    if (error == http::error::end_of_stream || error == beast::error::timeout) {
        linger();
    } else if (error == http::error::header_limit || error == http::error::buffer_overflow) {
        respond(error_response(431, fmt::format("the header is longer than {} bytes", largest_header)));
    } else if (error == http::error::body_limit) {
        respond(error_response(413, fmt::format("the body is longer than {} bytes", body_limit())));
    } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
               error != http::error::partial_message) {
        respond(error_response(400, "the request is not valid HTTP"));
    }
    // Anything else: the connection broke.
}

void HttpConnection::on_header(beast::error_code error) {
    if (error) {
        on_error(error);
        return;
    }
    const auto& message = parser_->get();
    request_.method = text_of(message.method_string());
    request_.secret = text_of(message["Talus-Person"]);
    if (auto refused = refusal()) {
        // Its body is not read.
        close_ = close_ || !message.keep_alive() || !parser_->is_done() || parser_->chunked() ||
                 parser_->content_length().value_or(0) > 0;
        respond(std::move(*refused));
        return;
    }
    if (parser_->is_done()) {
        handle();
    } else if (route_ != nullptr && route_->intake) {
        begin_intake();
    } else {
        parser_->body_limit(body_limit());
        read_body();
    }
}

std::optional<Response> HttpConnection::refusal() {
    const auto& message = parser_->get();
    const std::string host = header(http::field::host), origin = header(http::field::origin);
    if (message.count(http::field::host) != 1 || !context_.access.host_allowed(host)) {
        return error_response(403,
                              "this server is not known by the host name of the request; start it with --allow-host");
    }
    if (message.count(http::field::origin) > 1 || (!origin.empty() && !context_.access.origin_allowed(origin, host))) {
        return error_response(403, "the request comes from a page of another origin");
    }
    auto target = session::parse_target({message.target().data(), message.target().size()});
    if (!target) return error_response(400, target.error().message);
    request_.path = std::move(target->path);
    request_.query = std::move(target->query);

    const auto too_long = [&]() -> std::optional<Response> {
        if (parser_->content_length().value_or(0) <= body_limit()) return {};
        return error_response(413, fmt::format("the body is longer than {} bytes", body_limit()));
    };
    const bool websocket = request_.path == "/ws";
    if (!websocket && !request_.path.starts_with("/api/") && request_.path != "/api") {
        if (request_.method == "GET" || request_.method == "HEAD") return too_long();
        Response wrong = error_response(405, "the page's files can only be read");
        wrong.allow = "GET, HEAD";
        return wrong;
    }
    Role needs = Role::viewer;
    const std::vector<std::string>* keys = &websocket_keys;
    if (!websocket) {
        auto match = context_.router.find(request_.method, request_.path);
        if (match.route == nullptr && match.allow.empty() && context_.open) {
            asked_ = context_.open;
            match = asked_->router.find(request_.method, request_.path);
        }
        if (match.route == nullptr) {
            if (match.allow.empty() && !context_.open) return error_response(409, no_session_open);
            if (match.allow.empty()) return error_response(404, "there is no such route; see /api/openapi.json");
            Response wrong =
                error_response(405, "this route has no method " + request_.method + "; it has " + match.allow);
            wrong.allow = match.allow;
            return wrong;
        }
        route_ = match.route;
        request_.parameters = std::move(match.parameters);
        needs = route_->needs;
        keys = &route_->query;
    }
    if (auto refused = refuse_keys(request_.query, *keys)) return refused;
    std::string token;
    if (websocket) {
        token = request_.query["token"];
    } else {
        constexpr std::string_view scheme = "Bearer ";
        const std::string authorization = header(http::field::authorization);
        if (authorization.starts_with(scheme)) token = authorization.substr(scheme.size());
    }
    request_.role = context_.access.role_of(token);
    if (may(request_.role, needs)) return too_long();
    return refuse_role(request_.role, needs, !token.empty());
}

void HttpConnection::read_body() {
    stream_.expires_after(context_.patience);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (error) {
            self->on_error(error);
        } else {
            self->handle();
        }
    });
}

void HttpConnection::handle() {
    close_ = !parser_->get().keep_alive();
    if (request_.path == "/ws") {
        upgrade();
    } else if (route_ == nullptr) {
        give_file();
    } else if (asked_is_closed()) {
        respond(error_response(409, another_scene));
    } else {
        stream_.expires_never();
        request_.body = std::move(parser_->get().body());
        route_->handler(request_, respond_later());
    }
}

Respond HttpConnection::respond_later() {
    return [held = std::make_shared<Held>(shared_from_this())](Response response) {
        std::shared_ptr<HttpConnection> self = std::move(held->connection);
        const auto executor = self->stream_.get_executor();
        asio::post(executor, [self = std::move(self), response = std::move(response)]() mutable {
            self->respond(std::move(response));
        });
    };
}

void HttpConnection::end_intake(Response response) {
    intake_ = nullptr;
    close_ = true;
    respond(std::move(response));
}

void HttpConnection::begin_intake() {
    if (asked_is_closed()) return end_intake(error_response(409, another_scene));
    close_ = !parser_->get().keep_alive();
    pieces_.emplace(std::move(*parser_));
    pieces_->body_limit(body_limit());
    intake_ = route_->intake(request_);
    piece_.resize(piece_size);
    read_piece();
}

void HttpConnection::read_piece() {
    auto& body = pieces_->get().body();
    body.data = piece_.data();
    body.size = piece_.size();
    body.more = true;
    stream_.expires_after(context_.patience);
    http::async_read(stream_, buffer_, *pieces_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_piece(error); });
}

void HttpConnection::on_piece(beast::error_code error) {
    if (error && error != http::error::need_buffer) {
        intake_ = nullptr;  // discards what came
        on_error(error);
        return;
    }
    stream_.expires_never();
    if (asked_is_closed()) return end_intake(error_response(409, another_scene));
    const std::size_t count = piece_.size() - pieces_->get().body().size;
    const auto held = std::make_shared<Held>(shared_from_this());
    intake_->take(piece_.substr(0, count), [held](std::optional<Response> refused) {
        std::shared_ptr<HttpConnection> self = std::move(held->connection);
        const auto executor = self->stream_.get_executor();
        asio::post(executor, [self = std::move(self), refused = std::move(refused)]() mutable {
            if (refused) {
                self->end_intake(std::move(*refused));
            } else if (self->asked_is_closed()) {
                self->end_intake(error_response(409, another_scene));
            } else if (self->pieces_->is_done()) {
                self->intake_->finish(self->respond_later());
            } else {
                self->read_piece();
            }
        });
    });
}

void HttpConnection::upgrade() {
    if (!beast::websocket::is_upgrade(parser_->get())) {
        respond(error_response(400, "/ws speaks WebSocket; this was an ordinary request"));
        return;
    }
    if (!context_.open) {
        respond(error_response(409, no_session_open));
        return;
    }
    if (context_.open->session.people().count() >= context_.people_limit) {
        respond(error_response(503, fmt::format("{} people are here, the most there can be", context_.people_limit)));
        return;
    }
    stream_.expires_never();
    serve_websocket(std::move(stream_), parser_->release(), context_, request_.role, request_.query["name"],
                    request_.query["person"]);
}

void HttpConnection::give_file() {
    const Site::File* file = context_.site.find(request_.path);
    if (file == nullptr) {
        respond(error_response(404, "there is no such file"));
        return;
    }
    http::response<http::span_body<const char>> message;
    const std::string host = header(http::field::host);
    const bool packed = file->gzipped && header(http::field::accept_encoding).find("gzip") != std::string::npos;
    body_ = packed ? file->gzipped : file->content;
    set_headers(message, *file, packed, host, context_.tile_origins());
    write(std::move(message));
}

void HttpConnection::respond(Response response) {
    http::response<http::span_body<const char>> message;
    set_headers(message, response);
    body_ = std::move(response.body);
    then_ = std::move(response.written);
    write(std::move(message));
}

void HttpConnection::write(http::response<http::span_body<const char>> message) {
    message.version(11);
    message.keep_alive(!close_);
    set_common_headers(message);
    message.content_length(body_->size());
    if (request_.method != "HEAD") message.body() = beast::span<const char>(body_->data(), body_->size());
    message_ = std::move(message);
    stream_.expires_after(context_.patience + seconds(body_->size() / slowest_reader));
    http::async_write(stream_, *message_,
                      [self = shared_from_this()](beast::error_code error, std::size_t) { self->on_written(error); });
}

void HttpConnection::on_written(beast::error_code error) {
    message_.reset();
    body_.reset();
    if (const auto then = std::exchange(then_, nullptr)) then();
    if (error) return;
    if (close_) {
        linger();
    } else {
        read_header();
    }
}

/// Closes the connection so that the answer arrives: otherwise data that the client still sends would make the system
/// discard it.
void HttpConnection::linger() {
    beast::error_code ignored;
    if (drained_ == 0) {
        stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
        stream_.expires_after(linger_time);
    }
    buffer_.consume(buffer_.size());
    stream_.async_read_some(buffer_.prepare(16 * 1024),
                            [self = shared_from_this()](beast::error_code error, std::size_t n) {
                                self->drained_ += n;
                                if (!error && self->drained_ < linger_bytes) self->linger();
                            });
}

}  // namespace

void serve_http(asio::ip::tcp::socket socket, ServerContext& context) {
    std::make_shared<HttpConnection>(std::move(socket), context)->read_header();
}

}  // namespace talus::serve
