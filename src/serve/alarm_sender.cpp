#include "serve/alarm_sender.hpp"

#include <thread>
#include <utility>

#include <fmt/format.h>

namespace talus::serve {

AlarmSender::AlarmSender(Executor& executor, Settings settings, MqttLink* link) : settings_(std::move(settings)) {
    const auto add = [&](std::string name, std::function<Status(const std::string&)> deliver) {
        queues_.push_back(std::make_unique<Queue>(executor));
        queues_.back()->name = std::move(name);
        queues_.back()->deliver = std::move(deliver);
    };
    if (settings_.webhook) {
        add(settings_.webhook->shown(), [this](const std::string& json) {
            return post_webhook(*settings_.webhook, json, settings_.limit, stopped_);
        });
    }
    if (link != nullptr) {
        add("MQTT", [this, link](const std::string& json) { return link->publish(json, settings_.limit, stopped_); });
    }
}

std::vector<std::string> AlarmSender::receivers() const {
    std::vector<std::string> names;
    for (const auto& queue : queues_) names.push_back(queue->name);
    return names;
}

bool AlarmSender::rest(std::chrono::milliseconds time) const {
    const auto end = std::chrono::steady_clock::now() + time;
    while (!stop_ && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return !stop_;
}

Status AlarmSender::repeat(const std::function<Status()>& attempt) const {
    std::size_t tries = 1;
    Status last = attempt();
    while (!last && tries <= settings_.waits.size() && rest(settings_.waits[tries - 1])) {
        last = attempt();
        ++tries;
    }
    if (last) return last;
    return Error{fmt::format("{} (tried {} times)", last.error().message, tries)};
}

void AlarmSender::send(const std::string& json, const std::function<void(const Outcome&)>& told) {
    for (std::size_t k = 0; k < queues_.size(); ++k) {
        Queue& queue = *queues_[k];
        if (queue.waiting >= most_waiting) {
            told({k, false, fmt::format("not sent to {}: {} messages wait already", queue.name, most_waiting),
                  queue.waiting});
            continue;
        }
        ++queue.waiting;
        queue.lane.post([this, k, &queue, json, told] {
            --queue.waiting;
            if (stop_) return;
            const Status sent = repeat([&] { return queue.deliver(json); });
            if (stop_) return;
            told({k, sent.ok(), sent ? "sent to " + queue.name : "not delivered: " + sent.error().message,
                  queue.waiting});
        });
    }
}

}  // namespace talus::serve
