#include "scene/parse.hpp"

#include <cerrno>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "scene/scene.hpp"

namespace talus {
namespace {

constexpr std::uintmax_t largest_scene_file = 16 << 20;  // bytes; a scene is a page of text

/// Line of the first byte that is not UTF-8, 0 if there is none.
std::size_t line_of_invalid_utf8(std::string_view text) {
    std::size_t line = 1;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte == '\n') ++line;
        if (byte < 0x80) continue;
        const int more = byte >= 0xC2 && byte <= 0xDF   ? 1
                         : (byte & 0xF0) == 0xE0        ? 2
                         : byte >= 0xF0 && byte <= 0xF4 ? 3
                                                        : 0;
        if (more == 0 || i + more >= text.size()) return line;
        for (int k = 1; k <= more; ++k) {
            if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return line;
        }
        i += more;
    }
    return 0;
}

Result<std::string> read_text(const std::filesystem::path& file) {
    const std::string name = file.string();
    std::error_code code;
    const auto status = std::filesystem::status(file, code);
    if (!std::filesystem::exists(status)) return Error{name + ": no such scene file"};
    if (std::filesystem::is_directory(status)) {
        return Error{name + ": is a folder, not a scene file; name the .toml file in it"};
    }
    std::ifstream in(file, std::ios::binary);
    if (!in) return Error{name + ": cannot be opened: " + std::generic_category().message(errno)};
    std::string text;
    char block[65536];
    while (in.read(block, sizeof block), in.gcount() > 0) {
        text.append(block, static_cast<std::size_t>(in.gcount()));
        if (text.size() > largest_scene_file) return Error{name + ": is larger than 16 MB, not a scene file"};
    }
    if (in.bad()) return Error{name + ": cannot be read to its end"};
    if (const std::size_t line = line_of_invalid_utf8(text); line > 0) {
        return Error{fmt::format("{}:{}: not UTF-8 text; save the scene file as UTF-8", name, line)};
    }
    return text;
}

std::string text_of(const toml::node& node) {
    std::ostringstream out;
    out << toml::toml_formatter{node};
    return one_line(out.str(), 80);
}

/// The node as a value of the parameter's kind; nothing if it is of another kind.
std::optional<ParameterValue> to_value(const toml::node& node, ParameterKind kind) {
    switch (kind) {
        case ParameterKind::boolean:
            if (const auto value = node.value_exact<bool>()) return *value;
            return std::nullopt;
        case ParameterKind::integer: {
            if (const auto value = node.value_exact<std::int64_t>()) return *value;
            const auto number = node.value_exact<double>();  // 1e6 is a whole number to everybody but TOML
            if (number && std::abs(*number) < 9e15 && *number == std::floor(*number)) {
                return static_cast<std::int64_t>(*number);
            }
            return std::nullopt;
        }
        case ParameterKind::number:
            if (node.is_number()) return node.value<double>();
            return std::nullopt;
        case ParameterKind::text:
        case ParameterKind::path:
        case ParameterKind::choice:
            if (const auto value = node.value_exact<std::string>()) return *value;
            return std::nullopt;
        case ParameterKind::text_list: {
            const toml::array* items = node.as_array();
            if (!items) return std::nullopt;
            std::vector<std::string> texts;
            for (const toml::node& item : *items) {
                const auto text = item.value_exact<std::string>();
                if (!text) return std::nullopt;
                texts.push_back(*text);
            }
            return texts;
        }
        case ParameterKind::extent: {
            const toml::array* items = node.as_array();
            if (!items || items->size() != 4) return std::nullopt;
            double numbers[4];
            for (std::size_t i = 0; i < 4; ++i) {
                if (!items->get(i)->is_number()) return std::nullopt;
                numbers[i] = *items->get(i)->value<double>();
            }
            return Extent{numbers[0], numbers[1], numbers[2], numbers[3]};
        }
    }
    return std::nullopt;
}

std::string header_of(const Section& section) {
    return section.repeats ? "[[" + section.name + "]]" : "[" + section.name + "]";
}

/// Where the key belongs, or the nearest one of the section.
std::string unknown_key(const Section& section, std::string_view key) {
    const std::string start = fmt::format("unknown key \"{}\" in {}; ", one_line(key, 80), header_of(section));
    std::vector<std::string> keys;
    for (const Parameter& parameter : section.parameters) keys.push_back(parameter.key);
    for (const Section& other : scene_sections()) {
        if (other.find(key)) return start + "it belongs in " + header_of(other);
    }
    return start + "nearest known key: " + nearest_word(key, keys);
}

std::string unknown_section(std::string_view name) {
    std::vector<std::string> names;
    for (const Section& section : scene_sections()) {
        names.push_back(section.name);
        if (section.find(name)) {
            return fmt::format("key \"{}\" stands outside a section; it belongs in {}", name, header_of(section));
        }
    }
    return fmt::format("unknown section \"{}\"; nearest known section: {}", one_line(name, 80),
                       nearest_word(name, names));
}

class SceneReader {
  public:
    explicit SceneReader(const std::filesystem::path& file) : name_(file.string()) { scene_.file = file; }

    Status read_file(const toml::table& root) {
        for (const auto& [key, node] : root) {
            const Section* section = find_section(key.str());
            if (!section) return Error{place(key.source()) + ": " + unknown_section(key.str())};
            if (Status s = read_section(*section, node, place(key.source())); !s) return s.error();
        }
        return {};
    }

    /// "section.key=value" or "section[index].key=value".
    Status read_override(const std::string& text) {
        const std::string where = "--set " + one_line(text, 120);
        const std::size_t equals = text.find('=');
        const std::size_t dot = text.find('.');
        if (equals == std::string::npos || dot == std::string::npos || dot > equals) {
            return Error{where + ": must read section.key=value or section[0].key=value"};
        }
        std::string section_name = text.substr(0, dot);
        std::optional<std::string> index_text;
        if (const std::size_t bracket = section_name.find('['); bracket != std::string::npos) {
            if (section_name.back() != ']') return Error{where + ": must read section[0].key=value"};
            index_text = section_name.substr(bracket + 1, section_name.size() - bracket - 2);
            section_name.resize(bracket);
        }
        const Section* section = find_section(section_name);
        if (!section) return Error{where + ": " + unknown_section(section_name)};
        const std::string key = text.substr(dot + 1, equals - dot - 1);
        const Parameter* parameter = section->find(key);
        if (!parameter) return Error{where + ": " + unknown_key(*section, key)};
        const Result<std::size_t> index = override_index(*section, index_text, where);
        if (!index) return index.error();
        return override_value(*section, *index, *parameter, text.substr(equals + 1), where);
    }

    [[nodiscard]] Status check_required() const {
        for (const Section& section : scene_sections()) {
            for (std::size_t index = 0; index < section.count(scene_.spec); ++index) {
                for (const Parameter& parameter : section.parameters) {
                    const std::string path = key_path(section, index, parameter);
                    if (!parameter.required || scene_.places.count(path) > 0) continue;
                    const auto header = section_places_.find(section_path(section, index));
                    const std::string where = header == section_places_.end() ? name_ : header->second;
                    return Error{fmt::format("{}: {} is missing; it must be {}", where, path, allowed_text(parameter))};
                }
            }
        }
        if (scene_.spec.releases.empty()) {
            return Error{name_ + ": there is no [[release]]; a scene needs at least one"};
        }
        return {};
    }

    ParsedScene take() { return std::move(scene_); }

  private:
    [[nodiscard]] std::string place(const toml::source_region& region) const {
        return fmt::format("{}:{}", name_, region.begin.line);
    }

    static std::string section_path(const Section& section, std::size_t index) {
        return section.repeats ? fmt::format("{}[{}]", section.name, index) : section.name;
    }

    Status read_section(const Section& section, const toml::node& node, const std::string& where) {
        if (!section.repeats) {
            if (const toml::table* table = node.as_table()) return read_table(section, 0, *table, where);
            return Error{fmt::format("{}: {} must be one section; write [{}]", where, section.name, section.name)};
        }
        const toml::array* entries = node.as_array();
        if (!entries) {
            return Error{
                fmt::format("{}: there can be several of {}; write [[{}]]", where, section.name, section.name)};
        }
        for (const toml::node& entry : *entries) {
            const toml::table* table = entry.as_table();
            if (!table) {
                return Error{fmt::format("{}: {} must be sections; write [[{}]]", where, section.name, section.name)};
            }
            section.append(scene_.spec);
            const std::size_t index = section.count(scene_.spec) - 1;
            if (Status s = read_table(section, index, *table, place(table->source())); !s) return s.error();
        }
        return {};
    }

    Status read_table(const Section& section, std::size_t index, const toml::table& table, const std::string& where) {
        section_places_[section_path(section, index)] = where;
        for (const auto& [key, node] : table) {
            const Parameter* parameter = section.find(key.str());
            if (!parameter) return Error{place(key.source()) + ": " + unknown_key(section, key.str())};
            if (Status s = read_parameter(section, index, *parameter, node, place(key.source())); !s) return s.error();
        }
        return {};
    }

    Status read_parameter(const Section& section, std::size_t index, const Parameter& parameter, const toml::node& node,
                          const std::string& where) {
        const auto refused = [&](const std::string& allowed) {
            return Error{fmt::format("{}: {} = {} is refused; it must be {}", where,
                                     key_path(section, index, parameter), text_of(node), allowed)};
        };
        const std::optional<ParameterValue> value = to_value(node, parameter.kind);
        if (!value) return refused(allowed_text(parameter));
        if (const std::string problem = problem_with(parameter, *value); !problem.empty()) return refused(problem);
        if (parameter.required && toml_text(*value) == "\"\"") return refused(allowed_text(parameter) + ", not empty");
        parameter.set(scene_.spec, index, *value);
        scene_.places[key_path(section, index, parameter)] = where;
        return {};
    }

    [[nodiscard]] Result<std::size_t> override_index(const Section& section, const std::optional<std::string>& text,
                                                     const std::string& where) const {
        const std::size_t count = section.count(scene_.spec);
        if (!section.repeats) {
            if (text) return Error{fmt::format("{}: there is only one [{}]; leave out the index", where, section.name)};
            return std::size_t{0};
        }
        if (!text && count == 1) return std::size_t{0};
        const std::string range =
            count == 0 ? fmt::format("the scene has no [[{}]]", section.name)
                       : fmt::format("say which: {0}[0]{1}", section.name,
                                     count == 1 ? "" : fmt::format(" to {}[{}]", section.name, count - 1));
        const bool digits =
            text && !text->empty() && text->size() < 6 && text->find_first_not_of("0123456789") == std::string::npos;
        if (!digits || std::stoul(*text) >= count) return Error{where + ": " + range};
        return std::size_t{std::stoul(*text)};
    }

    Status override_value(const Section& section, std::size_t index, const Parameter& parameter,
                          const std::string& text, const std::string& where) {
        const bool can_be_absent =
            !parameter.required && std::holds_alternative<std::monostate>(default_value(section, parameter));
        if (text == "none" && can_be_absent) {
            parameter.set(scene_.spec, index, {});
            scene_.places.erase(key_path(section, index, parameter));
            return {};
        }
        const bool is_text = parameter.kind == ParameterKind::text || parameter.kind == ParameterKind::path ||
                             parameter.kind == ParameterKind::choice;
        const bool in_quotes = !text.empty() && (text.front() == '"' || text.front() == '\'');
        if (is_text && !in_quotes) {  // a shell has taken the quotes away already
            return read_parameter(section, index, parameter, toml::value<std::string>(text), where);
        }
        if (text.find('\n') == std::string::npos) {
            try {
                const toml::table table = toml::parse("v = " + text);
                return read_parameter(section, index, parameter, *table.get("v"), where);
            } catch (const toml::parse_error&) {  // falls through to the message below
            }
        }
        return Error{fmt::format("{}: {} = {} is refused; it must be {}", where, key_path(section, index, parameter),
                                 one_line(text, 80), allowed_text(parameter))};
    }

    std::string name_;
    ParsedScene scene_;
    std::map<std::string, std::string> section_places_;  // "release[0]" -> "scene.toml:8"
};

}  // namespace

std::string one_line(std::string_view text, std::size_t longest) {
    std::string out;
    for (const char c : text) {
        const bool space = static_cast<unsigned char>(c) <= ' ' || c == '\x7f';
        if (!space || (!out.empty() && out.back() != ' ')) out += space ? ' ' : c;
    }
    if (out.size() > longest) {
        std::size_t end = longest;
        while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xC0) == 0x80) --end;  // not inside a UTF-8 character
        out = out.substr(0, end) + "...";
    }
    return out;
}

std::string ParsedScene::at(const std::string& key_path) const {
    const auto found = places.find(key_path);
    return (found == places.end() ? file.string() : found->second) + ": " + key_path;
}

Result<ParsedScene> parse_scene_with_places(const std::filesystem::path& file,
                                            const std::vector<std::string>& overrides) {
    const Result<std::string> text = read_text(file);
    if (!text) return text.error();
    SceneReader reader(file);
    try {
        const toml::table root = toml::parse(*text, file.string());
        if (Status s = reader.read_file(root); !s) return s.error();
    } catch (const toml::parse_error& error) {
        return Error{fmt::format("{}:{}: not valid TOML: {}", file.string(), error.source().begin.line,
                                 one_line(error.description()))};
    }
    for (const std::string& override_text : overrides) {
        if (Status s = reader.read_override(override_text); !s) return s.error();
    }
    if (Status s = reader.check_required(); !s) return s.error();
    ParsedScene scene = reader.take();
    if (Status s = finish_scene(scene); !s) return s.error();
    return scene;
}

Result<SceneSpec> parse_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    Result<ParsedScene> scene = parse_scene_with_places(file, overrides);
    if (!scene) return scene.error();
    return std::move(scene->spec);
}

}  // namespace talus
