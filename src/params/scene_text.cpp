#include "params/scene_text.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace talus::params {
namespace {

constexpr std::size_t line_length = 110;

/// Breaks text at spaces; every line begins with `prefix`.
std::string wrapped(const std::string& text, const std::string& prefix) {
    std::string out, line;
    const auto flush = [&] {
        out += prefix + line;
        while (!out.empty() && out.back() == ' ') out.pop_back();
        out += '\n';
        line.clear();
    };
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
        const std::string word = text.substr(begin, end - begin);
        if (!line.empty() && prefix.size() + line.size() + 1 + word.size() > line_length) flush();
        line += (line.empty() ? "" : " ") + word;
        if (end < text.size() && text[end] == '\n') flush();
        begin = end + 1;
    }
    if (!line.empty()) flush();
    return out;
}

std::string header_of(const Section& section) {
    return section.repeats ? "[[" + section.name + "]]" : "[" + section.name + "]";
}

/// Describes the section and its mutually exclusive keys.
/// Its help, and what others call it.
std::string meaning_of(const Parameter& parameter) {
    if (parameter.synonyms.empty()) return parameter.help;
    return fmt::format("{} Elsewhere: {}.", parameter.help, fmt::join(parameter.synonyms, ", "));
}

std::string help_of(const Section& section) {
    std::string text = section.help;
    for (const Alternatives& choice : section.alternatives) {
        text += fmt::format(" {} one of {} {} be given.", choice.required ? "Exactly" : "At most",
                            fmt::join(choice.keys, ", "), choice.required ? "must" : "may");
    }
    return text;
}

/// "0.4", "required", or what happens where there is no default.
std::string default_text(const Section& section, const Parameter& parameter) {
    if (parameter.required) return "required";
    const ParameterValue value = default_value(section, parameter);
    if (std::holds_alternative<std::monostate>(value)) return parameter.absent;
    return std::holds_alternative<double>(value) ? plain_text(value) : toml_text(value);
}

/// Lists of texts are written with one text per line.
std::string assignment(const Parameter& parameter, const ParameterValue& value) {
    const auto* list = std::get_if<std::vector<std::string>>(&value);
    if (!list || list->empty()) return parameter.key + " = " + toml_text(value) + "\n";
    std::string out = parameter.key + " = [\n";
    for (const std::string& text : *list) out += "    " + toml_text(text) + ",\n";
    return out + "]\n";
}

std::string parameter_lines(const Section& section, const Parameter& parameter, const ParameterValue& value) {
    const ParameterValue default_here = default_value(section, parameter);
    std::string about = parameter.help;
    if (parameter.kind != ParameterKind::text && parameter.kind != ParameterKind::path) {
        about += " Allowed: " + allowed_text(parameter) + ".";
    }
    about += parameter.required ? " Required." : " Default: " + default_text(section, parameter) + ".";
    const std::string out = wrapped(about, "# ");
    const std::string written = toml_text(value);
    if (written != toml_text(default_here) && !written.empty()) return out + assignment(parameter, value);
    // A value here would look like the default: whoever removes the # would change the scene.
    const std::string shown = toml_text(default_here);
    return out + "# " + parameter.key + " = " + (shown.empty() ? "none" : shown) + "\n";
}

std::string markdown_cell(std::string text) {
    for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, "\\");
    return text;
}

std::string allowed_without_unit(const Parameter& parameter) {
    Parameter bare = parameter;
    bare.unit.clear();
    return allowed_text(bare);
}

}  // namespace

std::string write_scene(const SceneSpec& spec, const std::string& header) {
    std::string out = header.empty() ? "" : wrapped(header, "# ") + "\n";
    for (const Section& section : scene_sections()) {
        const std::size_t count = section.count(spec);
        for (std::size_t index = 0; index < count; ++index) {
            if (index == 0) out += wrapped(help_of(section), "# ");
            out += header_of(section) + "\n";
            for (const Parameter& parameter : section.parameters) {
                out += parameter_lines(section, parameter, parameter.get(spec, index));
            }
            out += "\n";
        }
        if (count == 0) {
            SceneSpec example;
            section.append(example);
            out += wrapped(help_of(section), "# ") + "# " + header_of(section) + "\n";
            for (const Parameter& parameter : section.parameters) {
                out += parameter_lines(section, parameter, default_value(section, parameter));
            }
            out += "\n";
        }
    }
    out.pop_back();
    return out;
}

const std::vector<std::string>& first_keys() {
    static const std::vector<std::string> keys = {
        "scene.title",
        "scene.description",
        "scene.assumptions",
        "scene.sources",
        "terrain.file",
        "terrain.extent_m",
        "release.name",
        "release.file",
        "release.thickness_m",
        "release.volume_m3",
        "buildings.file",
        "buildings.default_height_m",
        "material.friction_coefficient",
        "material.internal_friction_coefficient",
        "material.turbulent_friction_mps2",
        "material.pore_pressure_ratio",
        "material.rest_density_kgpm3",
        "solver.target_particle_count",
        "solver.end_time_s",
        "solver.model",
    };
    return keys;
}

std::string write_short_scene(const SceneSpec& spec, const std::string& header) {
    std::string out = header.empty() ? "" : wrapped(header, "# ") + "\n";
    for (const Section& section : scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            std::string lines;
            for (const Parameter& parameter : section.parameters) {
                const std::string name = section.name + "." + parameter.key;
                const ParameterValue value = parameter.get(spec, index);
                const bool first = std::find(first_keys().begin(), first_keys().end(), name) != first_keys().end();
                if (first || toml_text(value) != toml_text(default_value(section, parameter))) {
                    lines += parameter_lines(section, parameter, value);
                }
            }
            if (!lines.empty()) out += header_of(section) + "\n" + lines + "\n";
        }
    }
    out.pop_back();
    return out;
}

std::string scene_reference_markdown() {
    std::string out =
        "# Scene reference\n\n"
        "Generated from the field table by `talus scene reference --markdown`; a test keeps it current.\n\n"
        "A scene is a TOML file. Units are in the key names. Relative paths are taken from the scene file's folder, "
        "and "
        "`${NAME}` in a path from the environment. On the command line `--set section.key=value` replaces a value, "
        "`--set release[0].key=value` one of the first release, and `none` as the value removes an optional key. A key "
        "that "
        "is marked live can also be changed in the live twin while debris moves.\n";
    for (const Section& section : scene_sections()) {
        out += fmt::format("\n## `{}`\n\n{}\n\n", header_of(section), help_of(section));
        out += "| Key | Unit | Default | Allowed | Live | Meaning |\n|---|---|---|---|---|---|\n";
        for (const Parameter& parameter : section.parameters) {
            const bool has_default = !std::holds_alternative<std::monostate>(default_value(section, parameter));
            std::string shown = default_text(section, parameter);
            if (has_default) shown.insert(0, "`").push_back('`');
            out += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", parameter.key, parameter.unit,
                               markdown_cell(shown), markdown_cell(allowed_without_unit(parameter)),
                               parameter.live.empty() ? "" : "live", markdown_cell(meaning_of(parameter)));
        }
    }
    return out;
}

std::string scene_reference_text() {
    std::string out;
    for (const Section& section : scene_sections()) {
        out += header_of(section) + "\n" + wrapped(help_of(section), "  ");
        for (const Parameter& parameter : section.parameters) {
            out += fmt::format("  {}\n", parameter.key);
            out += wrapped(parameter.help, "      ");
            out +=
                wrapped(fmt::format("Allowed: {}. {}.", allowed_text(parameter),
                                    parameter.required ? "Required" : "Default: " + default_text(section, parameter)),
                        "      ");
        }
        out += "\n";
    }
    return out;
}

}  // namespace talus::params
