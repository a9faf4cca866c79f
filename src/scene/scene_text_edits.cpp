#include "scene/scene_text_edits.hpp"

#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "params/fields.hpp"

namespace talus::scene {

std::map<std::string, toml::source_position> places_of(const toml::table& root) {
    std::map<std::string, toml::source_position> places;
    const auto add = [&](const std::string& section, const toml::table& table) {
        for (const auto& [key, node] : table) {
            places[fmt::format("{}.{}", section, std::string_view(key.str()))] = node.source().begin;
        }
    };
    for (const auto& [name, node] : root) {
        const std::string section(name.str());
        if (const toml::table* table = node.as_table()) add(section, *table);
        const toml::array* entries = node.as_array();
        for (std::size_t k = 0; entries && k < entries->size(); ++k) {
            if (const toml::table* table = entries->get(k)->as_table()) add(fmt::format("{}[{}]", section, k), *table);
        }
    }
    return places;
}

Status replace_string(std::string& text, const toml::source_position& place, const std::string& by) {
    std::size_t at = 0;
    for (std::size_t line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
    for (std::size_t column = 1; column < place.column && at + 1 < text.size(); ++at) {  // in characters, not bytes
        if ((static_cast<unsigned char>(text[at + 1]) & 0xC0) != 0x80) ++column;
    }
    const char quote = at < text.size() ? text[at] : '\0';
    std::size_t end = at + 1;
    while (end < text.size() && text[end] != quote && text[end] != '\n')
        end += quote == '"' && text[end] == '\\' ? 2 : 1;
    if ((quote != '"' && quote != '\'') || end >= text.size() || text[end] != quote ||
        text.compare(at, 3, "\"\"\"") == 0) {
        return Error{"write the path as one string in quotes"};
    }
    text.replace(at, end + 1 - at, params::toml_text(by));
    return {};
}

Result<std::string> text_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) return Error{file.string() + ": cannot be read"};
    std::string all = text.str();
    if (all.starts_with("\xEF\xBB\xBF")) all.erase(0, 3);
    return all;
}

}  // namespace talus::scene
