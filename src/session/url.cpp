#include "session/url.hpp"

#include <optional>

namespace talus::session {
namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// Empty: a bad percent sequence, or a control character.
std::optional<std::string> decode(std::string_view text, bool plus_is_blank) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '+' && plus_is_blank) {
            c = ' ';
        } else if (c == '%') {
            if (i + 2 >= text.size()) return {};
            const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
            if (high < 0 || low < 0) return {};
            c = static_cast<char>(16 * high + low);
            i += 2;
        }
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) return {};
        decoded += c;
    }
    return decoded;
}

}  // namespace

Result<Target> parse_target(std::string_view text) {
    const Error bad{"the address of the request is malformed"};
    if (text.empty() || text.front() != '/') return bad;
    const std::size_t mark = text.find('?');
    const auto path = decode(text.substr(0, mark), false);
    if (!path) return bad;
    Target target{*path, {}};
    std::string_view rest = mark == std::string_view::npos ? std::string_view() : text.substr(mark + 1);
    while (!rest.empty()) {
        const std::size_t end = rest.find('&');
        const std::string_view item = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
        const std::size_t equals = item.find('=');
        const auto key = decode(item.substr(0, equals), true);
        const auto value =
            decode(equals == std::string_view::npos ? std::string_view() : item.substr(equals + 1), true);
        if (!key || !value) return bad;
        if (key->empty()) continue;
        if (!target.query.emplace(*key, *value).second) {
            return Error{"the address of the request has " + key->substr(0, 40) + " twice"};
        }
    }
    return target;
}

}  // namespace talus::session
