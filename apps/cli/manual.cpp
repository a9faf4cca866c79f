// Manual pages and tab completion, from the declarations that also make --help.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command.hpp"
#include "params/fields.hpp"
#include "products/text_file.hpp"

namespace talus::cli {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
        text.replace(at, from.size(), to);
    }
    return text;
}

/// "-o,--output" -> {"-o", "--output"}.
std::vector<std::string> flags_of(const CLI::Option& option) {
    std::vector<std::string> flags;
    for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
    return flags;
}

// Manual pages, in the man macros of roff.

/// A line of running text: nothing in it is a request, and a hyphen is one that can be copied.
std::string roff(const std::string& text) {
    std::string escaped = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
    if (!escaped.empty() && (escaped.front() == '.' || escaped.front() == '\'')) escaped.insert(0, "\\&");
    return replaced(replaced(escaped, "\n.", "\n\\&."), "\n'", "\n\\&'");
}

std::string option_entry(const CLI::Option& option) {
    std::string title;
    for (const std::string& flag : flags_of(option)) {
        title += fmt::format("{}\\fB{}\\fR", title.empty() ? "" : ", ", roff(flag));
    }
    if (option.get_positional()) title = fmt::format("\\fI{}\\fR", roff(option.get_name(true)));
    const std::string type = option.get_type_name();
    if (!type.empty() && !option.get_positional()) title += fmt::format(" \\fI{}\\fR", roff(type));
    return fmt::format(".TP\n{}\n{}\n", title, roff(option.get_description()));
}

/// `path`: "talus scene check".
std::string manual_page(const CLI::App& app, const std::string& path) {
    const std::string name = replaced(path, " ", "-");
    std::string title = name;
    std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
    std::string page = fmt::format(".TH {} 1 \"\" \"talus {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n", roff(title),
                                   TALUS_VERSION, roff(name), roff(app.get_description()));
    page += fmt::format(".SH SYNOPSIS\n.B {}\n[\\fIOPTIONS\\fR]", roff(path));
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_positional()) page += fmt::format(" [\\fI{}\\fR]", roff(option->get_name(true)));
    }
    if (!commands_of(app).empty()) page += " [\\fICOMMAND\\fR]";
    page += "\n.SH OPTIONS\n";
    for (const CLI::Option* option : app.get_options()) page += option_entry(*option);
    if (const auto commands = commands_of(app); !commands.empty()) {
        page += ".SH COMMANDS\n";
        for (const CLI::App* command : commands) {
            page += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(command->get_name()), roff(command->get_description()));
        }
    }
    if (const std::string footer = app.get_footer(); !footer.empty()) {
        page += fmt::format(".SH DETAILS\n.nf\n{}\n.fi\n", roff(footer.substr(footer.find_first_not_of('\n'))));
    }
    return page +
           ".SH SEE ALSO\nWhat is called docs/ here is the folder share/doc/talus/docs of the installation; on Debian, "
           "the package "
           "talus\\-doc has it: /usr/share/doc/talus/docs.\n";
}

// Tab completion.

/// Every command by its place: "" for the program, "/scene/check" for a command of a command.
using Places = std::map<std::string, const CLI::App*>;

void collect(const CLI::App& app, const std::string& place, Places& places) {
    places[place] = &app;
    for (const CLI::App* command : commands_of(app)) collect(*command, place + "/" + command->get_name(), places);
}

/// "/run|/scene|/scene/check", as a pattern of a shell.
std::string pattern_of(const Places& places) {
    std::string pattern;
    for (const auto& [place, app] : places) {
        if (!place.empty()) pattern += (pattern.empty() ? "" : "|") + place;
    }
    return pattern;
}

/// Options that take SECTION.KEY=..., as a pattern of a shell: "--set|--vary".
std::string key_options(const Places& places) {
    std::set<std::string> names;
    for (const auto& [place, app] : places) {
        for (const CLI::Option* option : app->get_options()) {
            if (option->get_type_name().starts_with("SECTION.KEY=")) names.insert("--" + option->get_lnames().front());
        }
    }
    return fmt::format("{}", fmt::join(names, "|"));
}

/// Calls `visit(name, parameter)` for every key of a scene, "material.viscosity".
template <class Visit>
void for_each_key(const Visit& visit) {
    for (const params::Section& section : params::scene_sections()) {
        for (const params::Parameter& parameter : section.parameters)
            visit(section.name + "." + parameter.key, parameter);
    }
}

/// The values of keys that have a list of them, as cases of a shell: `    "solver.backend") values="cpu cuda" ;;`.
std::string value_cases() {
    std::string cases;
    for_each_key([&](const std::string& name, const params::Parameter& parameter) {
        const bool yes_or_no = parameter.kind == params::ParameterKind::boolean;
        if (!yes_or_no && parameter.choices.empty()) return;
        const std::string values =
            yes_or_no ? std::string("true false") : fmt::format("{}", fmt::join(parameter.choices, " "));
        cases += fmt::format("        {}) values=\"{}\" ;;\n", name, values);
    });
    return cases;
}

std::string bash_completion(const Places& places) {
    std::string cases;
    for (const auto& [place, app] : places) {
        std::string words;
        for (const CLI::App* command : commands_of(*app)) words += command->get_name() + " ";
        for (const CLI::Option* option : app->get_options()) {
            for (const std::string& flag : flags_of(*option)) words += flag + " ";
        }
        if (!words.empty()) words.pop_back();
        cases += fmt::format("        \"{}\") words=\"{}\" ;;\n", place, words);
    }
    std::string keys;
    for_each_key([&](const std::string& name, const params::Parameter&) { keys += name + "= "; });
    keys.pop_back();
    return fmt::format(R"(# Tab completion of talus for bash.
# $1: what is begun of section.key=value. bash splits words at =; what it splits off is not part of the answer.
_talus_key() {{
    local raw=${{COMP_WORDS[COMP_CWORD]}} key=${{1%%=*}} values="" before=""
    compopt +o filenames 2>/dev/null
    if [[ $1 != *=* ]]; then
        compopt -o nospace 2>/dev/null
        COMPREPLY=($(compgen -W "{}" -- "$1"))
        return
    fi
    case "${{key/\[*\]/}}" in
{}    esac
    [[ $raw == ?*=* ]] && before=${{raw%=*}}=
    COMPREPLY=($(compgen -P "$before" -W "$values" -- "${{1#*=}}"))
}}
_talus() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} place="" words="" word glued="" before
    local -a line=("")
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        case "$place/$word" in
        {}) place="$place/$word" ;;
        esac
    done
    for word in "${{COMP_WORDS[@]:0:COMP_CWORD+1}}"; do
        if [[ $word == = || $glued ]]; then line[-1]+=$word; else line+=("$word"); fi
        [[ $word == = ]] && glued=1 || glued=""
    done
    before=${{line[-2]}}
    case "${{line[-1]}}" in
    {}) before=${{line[-1]%%=*}} line[-1]=${{line[-1]#*=}} ;;
    esac
    case "$before" in
    {}) _talus_key "${{line[-1]}}"; return ;;
    esac
    case "$place" in
{}    esac
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    [[ $current == -* ]] || COMPREPLY+=($(compgen -f -- "$current"))
}}
complete -o filenames -F _talus talus
)",
                       keys, value_cases(), pattern_of(places), replaced(key_options(places), "|", "=*|") + "=*",
                       key_options(places), cases);
}

/// An entry of _describe: 'name:what it is'.
std::string described(const std::string& name, const std::string& what) {
    return fmt::format("'{}:{}'", replaced(name, ":", "\\:"), replaced(what, "'", "'\\''"));
}

std::string zsh_completion(const Places& places) {
    std::string cases;
    for (const auto& [place, app] : places) {
        std::string commands, options;
        for (const CLI::App* command : commands_of(*app)) {
            commands += described(command->get_name(), command->get_description()) + " ";
        }
        for (const CLI::Option* option : app->get_options()) {
            for (const std::string& flag : flags_of(*option)) {
                options += described(flag, option->get_description()) + " ";
            }
        }
        cases += fmt::format("(\"{}\") commands=({}) options=({}) ;;\n", place, commands, options);
    }
    std::string keys;
    for_each_key([&](const std::string& name, const params::Parameter& parameter) {
        keys += "    " + described(name, parameter.help) + "\n";
    });
    return fmt::format(R"(#compdef talus
# Tab completion of talus for zsh.
local place="" word values=""
local -a commands options keys
if [[ $words[CURRENT-1] == ({}) ]] || compset -P '({})='; then
    if [[ $PREFIX == *=* ]]; then
        case "${{${{PREFIX%%=*}}/\[*\]/}}" in
{}        esac
        compset -P '*='
        compadd -- ${{=values}}
    else
        keys=(
{}    )
        _describe -t keys key keys -S =
    fi
    return
fi
for word in "${{(@)words[2,CURRENT-1]}}"; do
    case "$place/$word" in
    ({}) place="$place/$word" ;;
    esac
done
case "$place" in
{}esac
if [[ $PREFIX == -* ]]; then
    _describe -o option options
else
    (( $#commands )) && _describe command commands
    _files
fi
)",
                       key_options(places), key_options(places), value_cases(), keys, pattern_of(places), cases);
}

/// Every page, as NAME.1.
int write_manual(const CLI::App& program, const std::filesystem::path& folder) {
    Places places;
    collect(program, "", places);
    for (const auto& [place, app] : places) {
        const std::string path = program.get_name() + replaced(place, "/", " ");
        const std::filesystem::path file = folder / (replaced(path, " ", "-") + ".1");
        if (const Status s = products::write_text_file(file.string(), manual_page(*app, path)); !s) {
            return fail(exit_code::failure, s.error().message);
        }
    }
    return exit_code::success;
}

int print_manual(const CLI::App& program, const std::vector<std::string>& names) {
    const CLI::App* app = &program;
    std::string path = program.get_name();
    for (const std::string& name : names) {
        const auto commands = commands_of(*app);
        const auto found =
            std::find_if(commands.begin(), commands.end(), [&](const CLI::App* c) { return c->get_name() == name; });
        if (found == commands.end()) {
            std::vector<std::string> known(commands.size());
            std::transform(commands.begin(), commands.end(), known.begin(),
                           [](const CLI::App* command) { return command->get_name(); });
            return fail(exit_code::bad_input, fmt::format("{} {}: no such command; nearest: {}", path, name,
                                                          params::nearest_word(name, known)));
        }
        app = *found;
        path += " " + name;
    }
    return print_result(manual_page(*app, path));
}

}  // namespace

void add_manual(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* manual = program.add_subcommand("manual", "print the manual page of talus or of a command");
    const auto names = std::make_shared<std::vector<std::string>>();
    manual->add_option("command", *names, "such as scene check; default: the page of talus")->type_name("COMMAND");
    const auto folder = std::make_shared<std::string>();
    manual->add_option("--folder", *folder, "write the pages of all commands into this folder instead")
        ->type_name("DIR")
        ->check(CLI::ExistingDirectory);
    manual->footer("\nThe page is in the format of man: talus manual run | man -l -\n");
    commands.push_back({manual, [&program, names, folder] {
                            return folder->empty() ? print_manual(program, *names) : write_manual(program, *folder);
                        }});

    CLI::App* completion = program.add_subcommand("completion", "print tab completion for a shell");
    const auto shell = std::make_shared<std::string>();
    completion->add_option("shell", *shell, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
    completion->footer(
        "\nTo have it in this shell:      source <(talus completion bash)\n"
        "In every zsh, from a folder in fpath: talus completion zsh > _talus\n");
    commands.push_back({completion, [&program, shell] {
                            Places places;
                            collect(program, "", places);
                            return print_result(*shell == "bash" ? bash_completion(places) : zsh_completion(places));
                        }});
}

}  // namespace talus::cli
