#include "validate/page.hpp"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "core/try.hpp"
#include "products/text_file.hpp"
#include "report/page.hpp"
#include "report/results.hpp"
#include "report/table.hpp"
#include "validation_page_files.hpp"

namespace talus::validate {
namespace {

using report::Json;
using report::table;

constexpr const char* legend =
    "Deviation and tolerance are shares of the expected value, or in the quantity's own unit where 0 is expected. "
    "FAIL (known) is a failure that the case file announces, with its reason; rows that are only shown fail nothing.";

std::string summary_text(const std::vector<CaseResult>& results) {
    const Tally tally = count(results);
    double wall_time = 0;
    for (const CaseResult& result : results) wall_time += result.wall_time;
    return fmt::format(
        "{} quantities of {} cases: {} pass, {} fail ({} of them known), {} are only shown, {} were skipped. "
        "The cases took {:.0f} s in all.",
        tally.passed + tally.failed + tally.known_failures + tally.shown + tally.skipped, results.size(), tally.passed,
        tally.failed + tally.known_failures, tally.known_failures, tally.shown, tally.skipped, wall_time);
}

/// Remarks on a case in addition to its numbers: why it fails, why it was not run, notes.
std::vector<std::string> remarks(const CaseResult& result) {
    std::vector<std::string> said;
    const auto say = [&](const std::string& text) {
        if (std::find(said.begin(), said.end(), text) == said.end()) said.push_back(text);
    };
    if (!result.skipped.empty()) say("Skipped: " + result.skipped);
    for (const Row& row : result.rows) {
        if (row.verdict == Verdict::known_failure) say("Known failure: " + row.known_failure);
    }
    for (const std::string& note : result.notes) say(note);
    return said;
}

Json rows_of(const CaseResult& result) {
    Json rows = table({{"quantity", "Quantity", ""},
                       {"expected", "Expected", "", "", "n"},
                       {"computed", "Computed", "", "", "n"},
                       {"deviation", "Deviation", "", "", "n"},
                       {"tolerance", "Tolerance", "", "", "n"},
                       {"source", "Source", "", "", "source"},
                       {"result", "Result", ""}});
    for (const Row& row : result.rows) {
        const char* look = row.verdict == Verdict::pass                                            ? "pass"
                           : row.verdict == Verdict::fail || row.verdict == Verdict::known_failure ? "fail"
                                                                                                   : "other";
        rows["rows"].push_back({{"quantity", row.quantity},
                                {"expected", expected_text(row)},
                                {"computed", computed_text(row)},
                                {"deviation", deviation_text(row)},
                                {"tolerance", tolerance_text(row)},
                                {"source", row.source},
                                {"result", {{"value", verdict_text(row.verdict)}, {"verdict", look}}}});
    }
    return rows;
}

Json overview_of(const std::vector<CaseResult>& results) {
    Json rows = table({{"case", "Case", ""},
                       {"skipped", "", "", "", "", ""},
                       {"passed", "Pass", "", "f0"},
                       {"failed", "Fail", "", "f0"},
                       {"shown", "Shown", "", "f0"},
                       {"wall_time_s", "Time", "s", "f0"}});
    for (const CaseResult& result : results) {
        const Tally tally = count({result});
        const int failed = tally.failed + tally.known_failures;
        Json row = {
            {"case", {{"value", result.validation_case.title}, {"link", "#case-" + result.validation_case.name}}},
            {"passed", tally.passed},
            {"failed", failed},
            {"shown", tally.shown},
            {"wall_time_s", result.wall_time}};
        if (!result.skipped.empty()) row["skipped"] = "skipped";
        if (failed > 0) row["failed"] = {{"value", failed}, {"verdict", "fail"}};
        rows["rows"].push_back(std::move(row));
    }
    return rows;
}

Json case_data(const CaseResult& result) {
    const Case& c = result.validation_case;
    Json charts = Json::array();
    for (const Chart& chart : result.charts) charts.push_back(report::chart_json(drawing_of(chart)));
    return {{"name", c.name},
            {"title", c.title},
            {"about", c.description},
            {"remarks", remarks(result)},
            {"table", rows_of(result)},
            {"has_charts", !charts.empty()},
            {"charts", std::move(charts)}};
}

/// Text within a line or a cell of Markdown.
std::string markdown_text(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '|' || c == '*' || c == '_' || c == '<' || c == '`' || c == '[') out += '\\';
        out += c == '\n' ? ' ' : c;
    }
    return out;
}

std::string row_markdown(const Row& row) {
    const bool failed = row.verdict == Verdict::fail || row.verdict == Verdict::known_failure;
    const std::string verdict = verdict_text(row.verdict);
    return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", markdown_text(row.case_name),
                       markdown_text(row.quantity), expected_text(row), computed_text(row), deviation_text(row),
                       tolerance_text(row), markdown_text(row.source), failed ? "**" + verdict + "**" : verdict);
}

}  // namespace

Json page_data(const std::vector<CaseResult>& results) {
    Json all = report::results_head("talus validation");
    Json cases = Json::array();
    for (const CaseResult& result : results) cases.push_back(case_data(result));
    all.update({{"title", "Validation of " + all["program"].get<std::string>()},
                {"description", summary_text(results)},
                {"legend", legend},
                {"overview", overview_of(results)},
                {"cases", std::move(cases)}});
    return all;
}

std::string page_html(const Json& data) {
    Json page = data;
    page.update({{"report_name", ""},
                 {"masthead", "Validation"},
                 {"reconstruction", false},
                 {"status", {{"partial", false}}},
                 {"maps", nullptr}});
    return report::render(validation_page_files::page_html, page);
}

Status write_markdown(const std::vector<CaseResult>& results, const std::filesystem::path& file) {
    const std::filesystem::path folder = file.parent_path() / file.stem();
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return Error{fmt::format("{}: cannot make this folder: {}", folder.string(), error.message())};
    const Json head = report::results_head("talus validation");
    std::string text = fmt::format(
        "# Validation\n\nMade by `talus validate --markdown` of {} on {}. {}\n\n{}\n\n"
        "| Case | Quantity | Expected | Computed | Deviation | Tolerance | Source | Result |\n"
        "|---|---|---:|---:|---:|---:|---|---|\n",
        head["program"].get<std::string>(), head["date"].get<std::string>(), summary_text(results), legend);
    for (const CaseResult& result : results) {
        for (const Row& row : result.rows) text += row_markdown(row);
    }
    for (const CaseResult& result : results) {
        const Case& c = result.validation_case;
        text += fmt::format("\n## {}\n\n`{}`. {}\n", markdown_text(c.title), c.name, markdown_text(c.description));
        std::string list;
        for (const std::string& remark : remarks(result)) list += "- " + markdown_text(remark) + "\n";
        if (!list.empty()) text += "\n" + list;
        for (const Chart& chart : result.charts) {
            const std::string name = fmt::format("{}_{}.svg", c.name, chart.name);
            TALUS_TRY(products::write_text_file(folder / name, report::chart_file(drawing_of(chart))));
            text += fmt::format("\n![{}]({}/{})\n", markdown_text(chart.title), folder.filename().string(), name);
        }
    }
    return products::write_text_file(file, text);
}

}  // namespace talus::validate
