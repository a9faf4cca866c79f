#include "serve/trigger_message.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include <fmt/format.h>

#include "core/try.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

/// UTC alone: a time without its zone would be off by hours.
std::optional<WallTime> parse_time(const std::string& text) {
    std::tm t{};
    double second = 0;
    char zone = 0;
    int length = 0;
    const int read = std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d:%lf%c%n", &t.tm_year, &t.tm_mon, &t.tm_mday,
                                 &t.tm_hour, &t.tm_min, &second, &zone, &length);
    const bool plausible = read == 7 && zone == 'Z' && length == static_cast<int>(text.size()) && t.tm_year >= 1970 &&
                           t.tm_mon >= 1 && t.tm_mon <= 12 && t.tm_mday >= 1 && t.tm_mday <= 31 && t.tm_hour >= 0 &&
                           t.tm_hour <= 23 && t.tm_min >= 0 && t.tm_min <= 59 && second >= 0 && second < 61;
    if (!plausible) return {};
    t.tm_year -= 1900;
    t.tm_mon -= 1;
    const auto past_minute = std::chrono::milliseconds(std::llround(1000 * second));
    return std::chrono::system_clock::from_time_t(timegm(&t)) + past_minute;
}

}  // namespace

std::optional<double> TriggerMessage::discharge() const {
    const auto found = values.find("discharge_m3ps");
    if (found == values.end() || !found->is_number()) return {};
    return found->get<double>();
}

Result<TriggerMessage> read_trigger_message(std::string_view text, WallTime now) {
    if (text.size() > largest_trigger_message) {
        return Error{fmt::format("the message has {} bytes; it may have {}", text.size(), largest_trigger_message)};
    }
    TALUS_ASSIGN(const json message, session::parse_json(text));
    if (!message.is_object()) return Error{"the message must be a JSON object with trigger, the name of a trigger"};
    TALUS_TRY(twin::check_keys(message, {"trigger", "values", "time", "reason"}));
    TriggerMessage read;
    TALUS_ASSIGN(const auto name, twin::read_text(message, "trigger"));
    if (!name) return Error{"trigger: missing; it must be the name of a trigger of the scene"};
    read.trigger = *name;
    read.values = message.value("values", json::object());
    if (!read.values.is_object()) return Error{fmt::format("values = {}: must be an object", twin::shown(read.values))};
    TALUS_ASSIGN(const auto reason, twin::read_text(message, "reason", 200));
    read.reason = reason.value_or("");
    TALUS_ASSIGN(const auto time, twin::read_text(message, "time"));
    const auto parsed = time ? parse_time(*time) : now;
    if (!parsed) {
        return Error{
            fmt::format("time = {}: must be a time in UTC such as 2026-11-24T14:03:00Z", twin::shown(json(*time)))};
    }
    read.time = *parsed;
    if (now - read.time > oldest_message || read.time - now > earliest_message) {
        return Error{fmt::format("time = {}: must be at most {} s old and {} s ahead; here it is {}", *time,
                                 oldest_message.count(), earliest_message.count(), time_text(now))};
    }
    read.time = std::min(read.time, now);
    return read;
}

std::string time_text(WallTime time) {
    const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
    std::tm t{};
    gmtime_r(&seconds, &t);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", t.tm_year + 1900, t.tm_mon + 1, t.tm_mday, t.tm_hour,
                       t.tm_min, t.tm_sec);
}

}  // namespace talus::serve
