#include "serve/alarm_sender.hpp"

#include <thread>
#include <utility>

#include <fmt/format.h>

namespace talus::serve {

bool AlarmSender::rest(std::chrono::milliseconds time) const {
    const auto end = std::chrono::steady_clock::now() + time;
    while (!stop_ && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return !stop_;
}

Status AlarmSender::repeat(const std::function<Status()>& attempt) {
    std::size_t tries = 1;
    Status last = attempt();
    while (!last && tries <= settings_.waits.size() && rest(settings_.waits[tries - 1])) {
        last = attempt();
        ++tries;
    }
    if (last) return last;
    return Error{fmt::format("{} (tried {} times)", last.error().message, tries)};
}

void AlarmSender::send(std::string json, std::function<void(bool, const std::string&)> told) {
    if (waiting_ >= most_waiting) {
        told(false, fmt::format("not sent: {} messages wait already", most_waiting));
        return;
    }
    ++waiting_;
    worker_.post([this, json = std::move(json), told = std::move(told)] {
        --waiting_;
        if (stop_) return;
        const std::function<bool()> stop = [this] { return stop_.load(); };
        std::string outcome;
        bool reached = true;
        const auto note = [&](const Status& status, const std::string& receiver) {
            reached = reached && status;
            if (!outcome.empty()) outcome += "; ";
            outcome += status ? "sent to " + receiver : "not delivered: " + status.error().message;
        };
        if (settings_.webhook) {
            note(repeat([&] { return post_webhook(*settings_.webhook, json, settings_.limit, stop); }),
                 settings_.webhook->shown());
        }
        if (link_ != nullptr) note(repeat([&] { return link_->publish(json, settings_.limit, stop); }), "MQTT");
        if (!stop_) told(reached, outcome);
    });
}

}  // namespace talus::serve
