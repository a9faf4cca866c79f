#include "scene/parse.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "core/try.hpp"
#include "scene/scene.hpp"
#include "scene/toml_file.hpp"

namespace talus::scene {
namespace {

std::string header_of(const params::Section& section) {
    return section.repeats ? "[[" + section.name + "]]" : "[" + section.name + "]";
}

/// The section that a key belongs to, or what it is called there; empty: neither.
std::string where_it_belongs(std::string_view key) {
    for (const params::Section& section : params::scene_sections()) {
        if (section.find(key)) return "it belongs in " + header_of(section);
    }
    for (const params::Section& section : params::scene_sections()) {
        if (const auto keys = params::keys_called(section, key); !keys.empty()) {
            return fmt::format("it belongs in {} as {}", header_of(section), fmt::join(keys, " or "));
        }
    }
    return "";
}

/// What others call so here, the section the key belongs to, or the nearest key of this section.
std::string unknown_key(const params::Section& section, std::string_view key) {
    const std::string start = fmt::format("unknown key \"{}\" in {}; ", one_line(key, 80), header_of(section));
    if (const auto meant = params::keys_called(section, key); !meant.empty()) {
        return fmt::format("{}here it is called {}", start, fmt::join(meant, " or "));
    }
    if (const std::string elsewhere = where_it_belongs(key); !elsewhere.empty()) return start + elsewhere;
    std::vector<std::string> keys;
    for (const params::Parameter& parameter : section.parameters) keys.push_back(parameter.key);
    return start + "nearest known key: " + params::nearest_word(key, keys);
}

std::string unknown_section(std::string_view name) {
    if (const std::string section = where_it_belongs(name); !section.empty()) {
        return fmt::format("key \"{}\" stands outside a section; {}", one_line(name, 80), section);
    }
    std::vector<std::string> names;
    for (const params::Section& section : params::scene_sections()) names.push_back(section.name);
    return fmt::format("unknown section \"{}\"; nearest known section: {}", one_line(name, 80),
                       params::nearest_word(name, names));
}

constexpr std::string_view variant_override = "variant=";

class SceneReader {
  public:
    explicit SceneReader(const std::filesystem::path& file) : name_(file.string()) { scene_.file = file; }

    Status read_file(const toml::table& root) {
        for (const auto& [key, node] : root) {
            const params::Section* section = params::find_section(key.str());
            if (!section) return Error{place(key.source()) + ": " + unknown_section(key.str())};
            TALUS_TRY(read_section(*section, node, place(key.source())));
        }
        return {};
    }

    /// Checks the keys and values of every variant, whether it is run or not.
    [[nodiscard]] Status check_variants() const {
        for (std::size_t i = 0; i < scene_.spec.variants.size(); ++i) {
            SceneReader tried(*this);
            TALUS_TRY(tried.use_variant(i));
        }
        return {};
    }

    /// "section.key=value", "section[index].key=value", or "variant=NAME" for all that the variant sets.
    Status read_override(const std::string& text) {
        if (!text.starts_with(variant_override)) return read_value(text, "--set " + one_line(text, 120));
        const std::string name = text.substr(variant_override.size());
        std::vector<std::string> names;
        for (std::size_t i = 0; i < scene_.spec.variants.size(); ++i) {
            if (scene_.spec.variants[i].name == name) return use_variant(i);
            names.push_back(params::toml_text(scene_.spec.variants[i].name));
        }
        return Error{fmt::format("--variant {}: the scene has no [[variant]] of that name; {}", one_line(name, 80),
                                 names.empty() ? "it has none" : fmt::format("it has {}", fmt::join(names, ", ")))};
    }

    Status use_variant(std::size_t index) {
        const params::VariantSpec variant = scene_.spec.variants[index];
        const std::string where =
            fmt::format("{} \"{}\"", scene_.at(fmt::format("variant[{}].set", index)), variant.name);
        for (const std::string& text : variant.set) TALUS_TRY(read_value(text, where));
        return {};
    }

    /// "section.key=value" or "section[index].key=value".
    Status read_value(const std::string& text, const std::string& where) {
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
        const params::Section* section = params::find_section(section_name);
        if (!section) return Error{where + ": " + unknown_section(section_name)};
        const std::string key = text.substr(dot + 1, equals - dot - 1);
        const params::Parameter* parameter = section->find(key);
        if (!parameter) return Error{where + ": " + unknown_key(*section, key)};
        TALUS_ASSIGN(const std::size_t index, override_index(*section, index_text, where));
        return override_value(*section, index, *parameter, text.substr(equals + 1), where);
    }

    [[nodiscard]] Status check_required() const {
        for (const params::Section& section : params::scene_sections()) {
            for (std::size_t index = 0; index < section.count(scene_.spec); ++index) {
                for (const params::Parameter& parameter : section.parameters) {
                    const std::string path = key_path(section, index, parameter);
                    if (!parameter.required || scene_.places.count(path) > 0) continue;
                    return Error{fmt::format("{} is missing; it must be {}", scene_.at(path), allowed_text(parameter))};
                }
            }
        }
        if (scene_.spec.releases.empty() && scene_.spec.inflows.empty()) {
            return Error{name_ + ": there is no [[release]] and no [[inflow]]; a scene needs at least one"};
        }
        return {};
    }

    ParsedScene take() { return std::move(scene_); }

  private:
    [[nodiscard]] std::string place(const toml::source_region& region) const {
        return fmt::format("{}:{}", name_, region.begin.line);
    }

    static std::string section_path(const params::Section& section, std::size_t index) {
        return section.repeats ? fmt::format("{}[{}]", section.name, index) : section.name;
    }

    Status read_section(const params::Section& section, const toml::node& node, const std::string& where) {
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
            TALUS_TRY(read_table(section, index, *table, place(table->source())));
        }
        return {};
    }

    Status read_table(const params::Section& section, std::size_t index, const toml::table& table,
                      const std::string& where) {
        scene_.places[section_path(section, index)] = where;
        for (const auto& [key, node] : table) {
            const params::Parameter* parameter = section.find(key.str());
            if (!parameter) return Error{place(key.source()) + ": " + unknown_key(section, key.str())};
            TALUS_TRY(read_parameter(section, index, *parameter, node, place(key.source())));
        }
        return {};
    }

    Status read_parameter(const params::Section& section, std::size_t index, const params::Parameter& parameter,
                          const toml::node& node, const std::string& where) {
        const auto refused = [&](const std::string& allowed) {
            return Error{fmt::format("{}: {} = {} is refused; it must be {}", where,
                                     key_path(section, index, parameter), toml_text_of(node), allowed)};
        };
        const std::optional<params::ParameterValue> value = to_parameter_value(node, parameter.kind);
        if (!value) return refused(allowed_text(parameter));
        if (const std::string problem = problem_with(parameter, *value); !problem.empty()) return refused(problem);
        if (parameter.required && params::toml_text(*value) == "\"\"")
            return refused(allowed_text(parameter) + ", not empty");
        parameter.set(scene_.spec, index, *value);
        scene_.places[key_path(section, index, parameter)] = where;
        return {};
    }

    [[nodiscard]] Result<std::size_t> override_index(const params::Section& section,
                                                     const std::optional<std::string>& text,
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

    Status override_value(const params::Section& section, std::size_t index, const params::Parameter& parameter,
                          const std::string& text, const std::string& where) {
        const bool can_be_absent =
            !parameter.required && std::holds_alternative<std::monostate>(default_value(section, parameter));
        if (text == "none" && can_be_absent) {
            parameter.set(scene_.spec, index, {});
            scene_.places.erase(key_path(section, index, parameter));
            return {};
        }
        const bool is_text = parameter.kind == params::ParameterKind::text ||
                             parameter.kind == params::ParameterKind::path ||
                             parameter.kind == params::ParameterKind::choice;
        const bool in_quotes = !text.empty() && (text.front() == '"' || text.front() == '\'');
        drop_alternatives(section, index, parameter, where);
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

    /// An override replaces what was given elsewhere in place of its key, where neither is required.
    void drop_alternatives(const params::Section& section, std::size_t index, const params::Parameter& parameter,
                           const std::string& where) {
        for (const params::Alternatives& choice : section.alternatives) {
            const auto begin = choice.keys.begin(), end = choice.keys.end();
            if (choice.required || std::find(begin, end, parameter.key) == end) continue;
            for (const std::string& key : choice.keys) {
                const params::Parameter& other = *section.find(key);
                const auto given = scene_.places.find(key_path(section, index, other));
                if (key == parameter.key || given == scene_.places.end() || given->second == where) continue;
                other.set(scene_.spec, index, {});
                scene_.places.erase(given);
            }
        }
    }

    std::string name_;
    ParsedScene scene_;
};

}  // namespace

Result<ParsedScene> parse_scene_with_places(const std::filesystem::path& file,
                                            const std::vector<std::string>& overrides) {
    TALUS_ASSIGN(const toml::table root, read_toml_file(file, "scene"));
    SceneReader reader(file);
    TALUS_TRY(reader.read_file(root));
    TALUS_TRY(reader.check_variants());
    for (const std::string& override_text : overrides) {
        TALUS_TRY(reader.read_override(override_text));
    }
    TALUS_TRY(reader.check_required());
    ParsedScene scene = reader.take();
    TALUS_TRY(finish_scene(scene));
    return scene;
}

Result<params::SceneSpec> parse_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    TALUS_ASSIGN(ParsedScene scene, parse_scene_with_places(file, overrides));
    return std::move(scene.spec);
}

}  // namespace talus::scene
