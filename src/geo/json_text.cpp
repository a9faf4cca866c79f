#include "geo/json_text.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace talus::geo {
namespace {

/// What a text would take to parse.
struct Size {
    int deepest = 0;         // open brackets
    std::size_t values = 0;  // commas and opening brackets
};

Size size_of(std::string_view text) {
    Size size;
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            if (c == '"') quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '[' || c == '{') {
            size.deepest = std::max(size.deepest, ++depth);
            ++size.values;
        } else if (c == ',') {
            ++size.values;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return size;
}

}  // namespace

std::size_t json_values(std::string_view text) {
    return size_of(text).values;
}

Result<nlohmann::json> parse_json(std::string_view text, std::size_t most_values) {
    using Event = nlohmann::json::parse_event_t;
    const Size size = size_of(text);
    if (size.deepest > deepest_json) {
        return Error{fmt::format("is nested {} levels deep; at most {} are read", size.deepest, deepest_json)};
    }
    if (size.values > most_values) {
        return Error{fmt::format("holds {} values; at most {} are read", size.values, most_values)};
    }
    std::vector<std::set<std::string>> open;  // the keys of each object that is being read
    std::string twice;
    const auto watch = [&](int, Event event, nlohmann::json& parsed) {
        if (event == Event::object_start) {
            open.emplace_back();
        } else if (event == Event::object_end) {
            open.pop_back();
        } else if (event == Event::key && twice.empty()) {
            const auto& key = parsed.get_ref<const std::string&>();
            if (!open.back().insert(key).second) twice = key;
        }
        return true;
    };
    try {
        nlohmann::json parsed = nlohmann::json::parse(text, watch);
        if (twice.empty()) return parsed;
        return Error{fmt::format("has the key \"{}\" twice in one object", twice.substr(0, 60))};
    } catch (const nlohmann::json::parse_error& error) {
        return Error{fmt::format("is not valid JSON, at byte {}", error.byte)};
    } catch (const nlohmann::json::exception&) {
        return Error{"has a number that is out of range"};
    }
}

}  // namespace talus::geo
