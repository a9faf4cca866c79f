#include <algorithm>
#include <array>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <deque>
#include <memory>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string>
#include <sys/socket.h>
#include <utility>

#include "serve/connection.hpp"

namespace talus::serve {
namespace {

namespace websocket = boost::beast::websocket;
using std::chrono::seconds;

constexpr std::size_t longest_queue = 256;               // texts
constexpr std::size_t heaviest_queue = 8 * 1024 * 1024;  // bytes
constexpr int max_messages = 200;                        // per second, from a viewer
// Limit of unsent data in the system's buffer: with more, a slow viewer would see old frames.
constexpr int unsent_bytes = 256 * 1024;

class WebSocketViewer final : public Viewer, public std::enable_shared_from_this<WebSocketViewer> {
  public:
    WebSocketViewer(beast::tcp_stream stream, ServerContext& context, Role role, std::string name, std::string former)
        : context_(context),
          open_(context.open),
          count_(context.connections, address_of(stream.socket())),
          socket_(std::move(stream)),
          timer_(socket_.get_executor()),
          role_(role),
          name_(std::move(name)),
          former_(std::move(former)) {}

    void accept(HttpRequest request);

    void send(Bytes text) override;
    void offer(int scenario, Bytes frame) override;
    void set_rate(double rate_hz) override;
    void dismiss(Bytes last) override;

  private:
    /// The newest frame of a scenario that has not been sent, and when it may be.
    struct Slot {
        Bytes frame;
        Clock::time_point next{};
    };
    void read();
    void on_message();
    void pump();
    void write(Bytes message, bool text);
    [[nodiscard]] Slot* due_slot(Clock::time_point now);
    void wait_for_slot();
    void end();
    void end_politely(websocket::close_code code);

    ServerContext& context_;
    const OpenSessionPtr open_;
    ConnectionCounts::Counted count_;
    websocket::stream<beast::tcp_stream> socket_;
    asio::steady_timer timer_;
    Role role_;
    std::string name_, former_;
    beast::flat_buffer buffer_;
    std::deque<Bytes> texts_;
    std::size_t text_bytes_ = 0;
    std::array<Slot, Scenarios::max_count> slots_;
    Clock::duration interval_{};
    Bytes writing_;
    bool joined_ = false, ended_ = false, waiting_ = false, closing_ = false, dismissed_ = false;
    Clock::time_point second_began_{};
    int messages_ = 0;  // in this second
};

void WebSocketViewer::accept(HttpRequest request) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = seconds(10);
    timeout.idle_timeout = context_.patience / 2;  // after half of that without data, a ping is sent
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(largest_message);
    socket_.auto_fragment(false);  // a frame is sent without copying, in one piece
    auto& raw = socket_.next_layer().socket();
    beast::error_code ignored;
    raw.set_option(asio::ip::tcp::no_delay(true), ignored);
    setsockopt(raw.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent_bytes, sizeof unsent_bytes);
    const auto kept = std::make_shared<HttpRequest>(std::move(request));
    socket_.async_accept(*kept, [self = shared_from_this(), kept](beast::error_code error) {
        if (error || self->open_ != self->context_.open) return;
        self->joined_ = true;
        self->open_->session.join(*self, self->role_, self->name_, self->former_);
        self->read();
    });
}

void WebSocketViewer::read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (error) {
            self->end();
        } else {
            self->on_message();
        }
    });
}

void WebSocketViewer::on_message() {
    const auto now = Clock::now();
    if (now - second_began_ > seconds(1)) {
        second_began_ = now;
        messages_ = 0;
    }
    const auto data = buffer_.cdata();
    const bool welcome = !dismissed_ && ++messages_ <= max_messages && socket_.got_text() &&
                         open_->session.receive(*this, {static_cast<const char*>(data.data()), data.size()});
    buffer_.consume(buffer_.size());
    if (!welcome) {
        end_politely(websocket::close_code::policy_error);
        return;
    }
    if (!ended_) read();
}

void WebSocketViewer::send(Bytes text) {
    if (ended_) return;
    text_bytes_ += text->size();
    texts_.push_back(std::move(text));
    if (texts_.size() > longest_queue || text_bytes_ > heaviest_queue) {
        // Posted, since the session may be iterating over its viewers.
        asio::post(socket_.get_executor(), [self = shared_from_this()] { self->end(); });
        return;
    }
    pump();
}

void WebSocketViewer::dismiss(Bytes last) {
    joined_ = false;
    if (ended_) return;
    dismissed_ = true;
    slots_ = {};
    send(std::move(last));
}

void WebSocketViewer::offer(int scenario, Bytes frame) {
    if (ended_) return;
    slots_[static_cast<std::size_t>(scenario)].frame = std::move(frame);
    pump();
}

void WebSocketViewer::set_rate(double rate_hz) {
    interval_ = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate_hz));
    for (Slot& slot : slots_) slot.next = {};
}

WebSocketViewer::Slot* WebSocketViewer::due_slot(Clock::time_point now) {
    Slot* due = nullptr;
    for (Slot& slot : slots_) {
        if (slot.frame && slot.next <= now && (due == nullptr || slot.next < due->next)) due = &slot;
    }
    return due;
}

/// Sends the next message, unless one is being sent.
void WebSocketViewer::pump() {
    if (writing_ || ended_ || closing_) return;
    if (!texts_.empty()) {
        Bytes text = std::move(texts_.front());
        texts_.pop_front();
        text_bytes_ -= text->size();
        write(std::move(text), true);
        return;
    }
    if (dismissed_) {
        end_politely(websocket::close_code::going_away);
        return;
    }
    const auto now = Clock::now();
    if (Slot* slot = due_slot(now)) {
        slot->next = std::max(slot->next + interval_, now);
        write(std::exchange(slot->frame, nullptr), false);
    } else {
        wait_for_slot();
    }
}

void WebSocketViewer::wait_for_slot() {
    if (waiting_) return;
    const Slot* next = nullptr;
    for (const Slot& slot : slots_) {
        if (slot.frame && (next == nullptr || slot.next < next->next)) next = &slot;
    }
    if (next == nullptr) return;
    waiting_ = true;
    timer_.expires_at(next->next);
    timer_.async_wait([self = shared_from_this()](beast::error_code) {
        self->waiting_ = false;
        self->pump();
    });
}

void WebSocketViewer::write(Bytes message, bool text) {
    writing_ = std::move(message);
    socket_.text(text);
    socket_.async_write(asio::buffer(*writing_), [self = shared_from_this()](beast::error_code error, std::size_t) {
        self->writing_.reset();
        if (error) {
            self->end();
        } else {
            self->pump();
        }
    });
}

void WebSocketViewer::end_politely(websocket::close_code code) {
    if (ended_ || closing_) return;
    closing_ = true;
    if (writing_) {
        end();  // a connection that is writing cannot send another message
        return;
    }
    socket_.async_close(code, [self = shared_from_this()](beast::error_code) { self->end(); });
}

void WebSocketViewer::end() {
    if (std::exchange(ended_, true)) return;
    timer_.cancel();
    texts_.clear();
    slots_ = {};
    if (std::exchange(joined_, false)) open_->session.leave(*this);
    beast::error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
}

}  // namespace

void serve_websocket(beast::tcp_stream stream, HttpRequest request, ServerContext& context, Role role,
                     const std::string& name, const std::string& former) {
    std::make_shared<WebSocketViewer>(std::move(stream), context, role, name, former)->accept(std::move(request));
}

}  // namespace talus::serve
