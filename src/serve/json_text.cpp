#include "serve/json_text.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace talus::serve {
namespace {

/// Maximum number of open brackets; checked before the text is parsed.
int nesting(std::string_view text) {
    int depth = 0, deepest = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            if (c == '"') quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '[' || c == '{') {
            deepest = std::max(deepest, ++depth);
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return deepest;
}

}  // namespace

Result<nlohmann::json> parse_json(std::string_view text) {
    if (const int depth = nesting(text); depth > deepest_json) {
        return Error{fmt::format("the body is nested {} levels deep; at most {} are read", depth, deepest_json)};
    }
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::parse_error& error) {
        return Error{fmt::format("the body is not valid JSON, at byte {}", error.byte)};
    } catch (const nlohmann::json::exception&) {
        return Error{"the body has a number that is out of range"};
    }
}

std::string to_text(const nlohmann::json& content) {
    return content.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string tidy_name(std::string_view name, std::size_t longest) {
    // The dump replaces what is not UTF-8, so that the text below is.
    const std::string valid = nlohmann::json::parse(to_text(std::string(name))).get<std::string>();
    std::string tidy;
    std::size_t count = 0;
    for (std::size_t i = 0; i < valid.size();) {
        const auto lead = static_cast<unsigned char>(valid[i]);
        const std::size_t size = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
        // Below 0xA0 in two bytes: the second set of control characters.
        const bool control =
            lead < 0x20 || lead == 0x7F || (lead == 0xC2 && static_cast<unsigned char>(valid[i + 1]) < 0xA0);
        if (!control && !(tidy.empty() && lead == ' ')) {
            if (++count > longest) break;
            tidy.append(valid, i, size);
        }
        i += size;
    }
    while (!tidy.empty() && tidy.back() == ' ') tidy.pop_back();
    return tidy;
}

}  // namespace talus::serve
