#include "session/json_text.hpp"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "core/visible_text.hpp"
#include "geo/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::session {
namespace {

std::string utf8(const nlohmann::json& content) {
    return content.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

Result<nlohmann::json> parse_json(std::string_view text, std::size_t most_values) {
    Result<nlohmann::json> parsed = geo::parse_json(text, most_values);
    if (!parsed) return Error{"the body " + parsed.error().message};
    return parsed;
}

Result<nlohmann::json> read_object(std::string_view text, std::initializer_list<std::string_view> keys,
                                   std::size_t most_values) {
    TALUS_ASSIGN(auto body, parse_json(text, most_values));
    if (!body.is_object()) return Error{fmt::format("the body is an object with {}", fmt::join(keys, ", "))};
    TALUS_TRY(twin::check_keys(body, keys));
    return Result<nlohmann::json>(std::move(body));
}

std::string to_text(const nlohmann::json& content) {
    return visible(utf8(content), "\\\\");
}

std::string text_at(const nlohmann::json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string tidy_name(std::string_view name, std::size_t longest) {
    // The dump replaces what is not UTF-8, so that the text below is.
    const std::string valid = nlohmann::json::parse(utf8(std::string(name))).get<std::string>();
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

}  // namespace talus::session
