#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace talus::serve {

using WallTime = std::chrono::system_clock::time_point;

/// Bytes of a message, at most.
inline constexpr std::size_t largest_trigger_message = 4096;
/// How old a message may be, and how far ahead the sender's clock may be.
inline constexpr std::chrono::seconds oldest_message{300}, earliest_message{5};

/// What a program or a gauge sends, over HTTP or MQTT:
/// `{"trigger": name, "values": {"volume_m3", "pore_pressure_ratio", "discharge_m3ps"}, "time": "2026-11-24T14:03:00Z",
/// "reason": text}`.
struct TriggerMessage {
    std::string trigger;
    nlohmann::json values = nlohmann::json::object();
    WallTime time;  ///< as given, or when it came if that is earlier: a value ahead would outdate those after it
    std::string reason;

    /// The discharge; empty: it has none, or it is no number.
    [[nodiscard]] std::optional<double> discharge() const;
    /// Whether it holds a discharge and no other value.
    [[nodiscard]] bool is_reading() const { return values.size() == 1 && values.contains("discharge_m3ps"); }
};

/// Errors name key, value and what is allowed: no JSON, too long, unknown keys, a time that is too old or ahead. Values
/// are checked against the scene later.
[[nodiscard]] Result<TriggerMessage> read_trigger_message(std::string_view text, WallTime now);

/// "2026-11-24T14:03:00Z"
[[nodiscard]] std::string time_text(WallTime time);

}  // namespace talus::serve
