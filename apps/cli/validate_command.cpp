#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "params/fields.hpp"
#include "products/text_file.hpp"
#include "progress.hpp"
#include "temporary_folder.hpp"
#include "validate/page.hpp"
#include "validate/suite.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;
using validate::Case;
using validate::CaseResult;

/// Where a case lies: a folder as given, or of that name among the program's.
Result<fs::path> find_case(const std::string& text, const fs::path& builtin) {
    std::error_code error;
    if (fs::exists(fs::path(text) / "case.toml", error)) return fs::path(text);
    if (text.find('/') == std::string::npos && fs::exists(builtin / text / "case.toml", error)) return builtin / text;
    return Error{fmt::format("{}: neither a folder with a case.toml nor a case of the program; nearest: {}", text,
                             nearest_word(text, validate::builtin_case_names()))};
}

Result<std::vector<Case>> load_cases(const ValidateArguments& arguments, const fs::path& builtin) {
    std::vector<std::string> names = arguments.cases;
    if (names.empty()) names = validate::builtin_case_names();
    std::vector<Case> cases;
    for (const std::string& name : names) {
        const Result<fs::path> folder = find_case(name, builtin);
        if (!folder) return folder.error();
        Result<Case> loaded = validate::load_case(*folder);
        if (!loaded) return loaded.error();
        if (loaded->quick || !arguments.quick) cases.push_back(*std::move(loaded));
    }
    if (cases.empty()) return Error{"none of these cases is quick; leave out --quick"};
    return cases;
}

std::string list_text(const std::vector<Case>& cases) {
    std::size_t widest = 0;
    for (const Case& c : cases) widest = std::max(widest, c.name.size());
    std::string text;
    for (const Case& c : cases)
        text += fmt::format("{:<{}}  {}  {}\n", c.name, widest, c.quick ? "quick" : "     ", c.title);
    return text;
}

Status write_outputs(const ValidateArguments& arguments, const std::vector<CaseResult>& results) {
    if (!arguments.json.empty()) {
        if (Status s = write_text_file(arguments.json, validate::table_json(results)); !s) return s;
    }
    if (!arguments.html.empty()) {
        if (Status s = write_text_file(arguments.html, validate::page_html(results)); !s) return s;
    }
    if (!arguments.markdown.empty()) return validate::write_markdown(results, arguments.markdown);
    return {};
}

}  // namespace

int validate_command(const ValidateArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    for (const std::string& file : {arguments.json, arguments.html, arguments.markdown}) {
        if (Status s = check_output_file(file); !s) return fail(exit_code::bad_input, s.error().message);
    }
    const TemporaryFolder unpacked;
    if (unpacked.path().empty()) return fail(exit_code::failure, "cannot make a temporary folder; set TMPDIR");
    watch.remove_at_once(unpacked.path());
    const Result<fs::path> builtin = validate::unpack_builtin_cases(unpacked.path());
    if (!builtin) return fail(exit_code::failure, builtin.error().message);

    const Result<std::vector<Case>> cases = load_cases(arguments, *builtin);
    if (!cases) return fail(exit_code::bad_input, cases.error().message);
    if (arguments.list) {
        (void)std::fputs(list_text(*cases).c_str(), stdout);
        return exit_code::success;
    }

    const ProgressStyle style = progress_style(false, false);
    ProgressReporter progress(style);
    std::vector<CaseResult> results;
    for (std::size_t i = 0; i < cases->size() && !watch.stop_requested(); ++i) {
        const Case& c = (*cases)[i];
        const std::string heading = fmt::format("case {} of {}: {}", i + 1, cases->size(), c.name);
        progress.say(heading);
        validate::Watch told;
        told.stop_requested = &watch.stop_requested();
        told.thread_count = arguments.threads.value_or(0);
        if (style == ProgressStyle::bar) {
            told.on_progress = [&](const std::string& what) { progress.say(fmt::format("{}: {}", heading, what)); };
        }
        CaseResult result = validate::run_case(c, told);
        if (!watch.stop_requested()) results.push_back(std::move(result));
    }
    progress.clear();

    (void)std::fputs(validate::table_text(results).c_str(), stdout);
    if (Status s = write_outputs(arguments, results); !s) return fail(exit_code::failure, s.error().message);
    if (watch.stop_requested()) return exit_code::interrupted;
    const validate::Tally tally = validate::count(results);
    return tally.failed > 0 || (tally.known_failures > 0 && !arguments.known) ? exit_code::case_failed
                                                                              : exit_code::success;
}

}  // namespace talus
