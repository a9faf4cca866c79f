#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "core/number_or_null.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "params/fields.hpp"
#include "products/results_json.hpp"
#include "products/text_file.hpp"
#include "progress.hpp"
#include "run/time_left.hpp"
#include "thread_options.hpp"
#include "validate/page.hpp"
#include "validate/suite.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;
using validate::Case;
using validate::CaseResult;

struct ValidateArguments {
    std::vector<std::string> cases;                  ///< names or folders; empty: all cases of the program
    bool quick = false, list = false;                ///< quick: only the cases marked so
    bool known = false;                              ///< failures announced in the case files do not fail the command
    std::string json_file, results, html, markdown;  ///< files to write; empty: none
    ThreadOptions threads;
    std::string backend = "cpu";
    std::string data;   ///< value of TALUS_DATA; empty: as in the environment
    bool json = false;  ///< for programs, in place of the table
};

constexpr const char* validate_help = R"(
A case is a folder with a case.toml: what to compute, the expected values, and their sources. Without CASE all cases
embedded in the program are computed. The table shows every expectation; a failing one as FAIL, one that its case file
announces as FAIL (known). Cases whose data are missing are listed as skipped.

Exit codes:
    0  every expectation holds (with --known: all but the announced ones)
    1  the machine failed: disk full, out of memory
    2  bad input: command line or a case file; nothing was computed
    4  an expectation does not hold
  130  interrupted by Ctrl-C; the table shows the cases that were complete
)";

/// The folder of a case: as given, or of that name among the built-in ones.
Result<fs::path> find_case(const std::string& text, const fs::path& builtin) {
    std::error_code error;
    if (fs::exists(fs::path(text) / "case.toml", error)) return fs::path(text);
    if (text.find('/') == std::string::npos && fs::exists(builtin / text / "case.toml", error)) return builtin / text;
    if (text.ends_with(".json")) {
        return Error{
            fmt::format("{}: is no case; --json prints JSON lines, and --json-file {} writes the table", text, text)};
    }
    return Error{fmt::format("{}: neither a folder with a case.toml nor a case of the program; nearest: {}", text,
                             params::nearest_word(text, validate::builtin_case_names()))};
}

Result<std::vector<Case>> load_cases(const ValidateArguments& arguments, const fs::path& builtin) {
    std::vector<std::string> names = arguments.cases;
    if (names.empty()) names = validate::builtin_case_names();
    std::vector<Case> cases;
    for (const std::string& name : names) {
        TALUS_ASSIGN(const fs::path folder, find_case(name, builtin));
        TALUS_ASSIGN(Case loaded, validate::load_case(folder));
        if (loaded.quick || !arguments.quick) cases.push_back(std::move(loaded));
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
    if (!arguments.json_file.empty()) {
        TALUS_TRY(products::write_text_file(arguments.json_file, validate::table_json(results)));
    }
    if (!arguments.results.empty() || !arguments.html.empty()) {
        const report::Json data = validate::page_data(results);
        if (!arguments.results.empty()) TALUS_TRY(products::write_results(data, arguments.results));
        if (!arguments.html.empty()) TALUS_TRY(products::write_text_file(arguments.html, validate::page_html(data)));
    }
    if (!arguments.markdown.empty()) return validate::write_markdown(results, arguments.markdown);
    return {};
}

std::string progress_json(std::size_t done, std::size_t count, double wall_remaining) {
    const nlohmann::ordered_json event = {{"event", "progress"},
                                          {"cases_done", done},
                                          {"cases", count},
                                          {"wall_remaining_s", number_or_null<nlohmann::ordered_json>(wall_remaining)}};
    return event.dump();
}

double now_in_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string result_json(const std::vector<CaseResult>& results) {
    const validate::Tally tally = validate::count(results);
    const auto skipped =
        std::count_if(results.begin(), results.end(), [](const CaseResult& r) { return !r.skipped.empty(); });
    return nlohmann::ordered_json{{"event", "result"},      {"passed", tally.passed},
                                  {"failed", tally.failed}, {"known_failures", tally.known_failures},
                                  {"shown", tally.shown},   {"skipped_cases", skipped}}
        .dump();
}

/// The results of the cases that were not interrupted, in order. Most cases are small: two of
/// them are sooner done beside each other than one after the other.
std::vector<CaseResult> compute(const std::vector<Case>& cases, const ValidateArguments& arguments,
                                const SharedThreads& threads, InterruptWatch& watch) {
    // The long ones first, so that no thread is left with one at the end.
    std::vector<std::size_t> order(cases.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return !cases[i].quick; });

    const ProgressStyle style = progress_style(false, arguments.json);
    ProgressReporter progress(style);
    // An upper bound: the long cases come first.
    run::WorkClock clock(std::vector<double>(cases.size(), 1), threads.runs_at_once);
    std::size_t done = 0;
    std::vector<std::optional<CaseResult>> computed(cases.size());
    std::mutex reporting;
    std::size_t next = 0;
    const auto work = [&] {
        for (;;) {
            std::unique_lock lock(reporting);
            if (next == order.size() || watch.stop_requested()) return;
            const std::size_t place = next++, i = order[place];
            clock.begin(place, now_in_seconds());
            const std::string heading = fmt::format("case {} of {}: {}", next, cases.size(), cases[i].name);
            progress.say(heading);
            lock.unlock();
            validate::Watch told;
            told.stop_requested = &watch.stop_requested();
            told.thread_count = threads.threads_per_run;
            told.backend = backend_of(arguments.backend);
            if (style == ProgressStyle::bar) {
                told.on_progress = [&](const std::string& what) {
                    const std::scoped_lock say(reporting);
                    progress.say(fmt::format("{}: {}", heading, what));
                };
            }
            CaseResult result = validate::run_case(cases[i], told);
            if (watch.stop_requested()) return;
            computed[i] = std::move(result);
            const std::scoped_lock say(reporting);
            ++done;
            clock.end(place, now_in_seconds());
            if (style == ProgressStyle::json) {
                (void)print(progress_json(done, cases.size(), clock.wall_remaining(now_in_seconds())) + "\n");
            }
        }
    };
    {
        std::vector<std::jthread> workers;
        for (int k = 1; k < threads.runs_at_once; ++k) workers.emplace_back(work);
        work();
    }
    progress.clear();
    std::vector<CaseResult> results;
    for (std::optional<CaseResult>& result : computed) {
        if (result) results.push_back(std::move(*result));
    }
    return results;
}

int validate_command(const ValidateArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    for (const std::string& file : {arguments.json_file, arguments.results, arguments.html, arguments.markdown}) {
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
        return print_result(list_text(*cases));
    }

    const Result<SharedThreads> threads = share_threads(arguments.threads, static_cast<int>(cases->size()));
    if (!threads) return fail(exit_code::bad_input, threads.error().message);
    if (arguments.json) (void)print(progress_json(0, cases->size(), std::numeric_limits<double>::quiet_NaN()) + "\n");
    const std::vector<CaseResult> results = compute(*cases, arguments, *threads, watch);
    const int printed = print_result(arguments.json ? result_json(results) + "\n" : validate::table_text(results));
    if (Status s = write_outputs(arguments, results); !s) return fail(exit_code::failure, s.error().message);
    if (watch.stop_requested()) return exit_code::interrupted;
    const validate::Tally tally = validate::count(results);
    return tally.failed > 0 || (tally.known_failures > 0 && !arguments.known) ? exit_code::case_failed : printed;
}

}  // namespace

void add_validate(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("validate", "compute cases with known results, print one table");
    const auto validate = std::make_shared<ValidateArguments>();
    app->add_option("cases", validate->cases, "names or folders of cases; default: all cases of the program")
        ->type_name("CASE");
    app->add_flag("--quick", validate->quick, "only the quick cases: under two minutes on two cores");
    app->add_flag("--list", validate->list, "list the cases instead of computing them");
    app->add_flag("--known", validate->known, "announced failures do not cause exit code 4");
    app->add_option("--json-file", validate->json_file, "write the table as a list of objects")->type_name("FILE");
    app->add_option("--results", validate->results, "write all that the page shows, as data (results.json)")
        ->type_name("FILE");
    app->add_option("--html", validate->html, "write a page with the table and a plot for each case")
        ->type_name("FILE");
    app->add_option("--markdown", validate->markdown,
                    "write the same as Markdown, with its plots in a folder beside it")
        ->type_name("FILE");
    add_thread_options(*app, validate->threads, "cases", "all cores");
    app->add_option("--backend", validate->backend,
                    "what moves the particles: cpu, cuda (a graphics card), auto, or host (the card's code on the "
                    "processor); default: cpu")
        ->type_name("NAME")
        ->check(usable_backend());
    app->add_option("--data", validate->data, "folder for TALUS_DATA, for cases on real terrain")->type_name("DIR");
    app->add_flag("--json", validate->json,
                  "progress and counts as one JSON object per line on stdout, in place of the table");
    add_retired_option(*app, "--progress-json", "is now --json");
    app->footer(validate_help);
    commands.push_back({app, [validate] { return validate_command(*validate); }});
}

}  // namespace talus::cli
