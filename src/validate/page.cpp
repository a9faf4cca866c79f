#include "validate/page.hpp"

#include <algorithm>
#include <ctime>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/try.hpp"
#include "products/report_text.hpp"
#include "products/text_file.hpp"
#include "validation_page_files.hpp"

namespace talus::validate {
namespace {

using report::escape;

constexpr const char* legend =
    "Deviation and tolerance are shares of the expected value, or in the quantity's own unit where 0 is expected. "
    "FAIL (known) is a failure that the case file announces, with its reason; rows that are only shown fail nothing.";

std::string now_text() {
    return fmt::format("{:%d %B %Y, %H:%M} UTC", fmt::gmtime(std::time(nullptr)));
}

std::string summary_text(const std::vector<CaseResult>& results) {
    const Tally tally = count(results);
    double wall_time = 0;
    for (const CaseResult& result : results) wall_time += result.wall_time;
    return fmt::format(
        "{} quantities of {} cases: {} pass, {} fail ({} of them known), {} are only shown, {} were skipped. "
        "Computed in {:.0f} s.",
        tally.passed + tally.failed + tally.known_failures + tally.shown + tally.skipped, results.size(), tally.passed,
        tally.failed + tally.known_failures, tally.known_failures, tally.shown, tally.skipped, wall_time);
}

std::string row_html(const Row& row) {
    const char* css = row.verdict == Verdict::pass                                            ? "pass"
                      : row.verdict == Verdict::fail || row.verdict == Verdict::known_failure ? "fail"
                                                                                              : "other";
    const auto cell = [](const std::string& text, const char* attributes) {
        return fmt::format("<td{}>{}</td>", attributes, escape(text));
    };
    constexpr const char* number = " class=\"n\"";
    return "<tr>" + cell(row.quantity, "") + cell(expected_text(row), number) + cell(computed_text(row), number) +
           cell(deviation_text(row), number) + cell(tolerance_text(row), number) +
           cell(row.source, " class=\"source\"") +
           fmt::format("<td><span class=\"verdict {}\">{}</span></td></tr>\n", css, verdict_text(row.verdict));
}

std::string overview_html(const CaseResult& result) {
    const Case& c = result.validation_case;
    const Tally tally = count({result});
    const int failed = tally.failed + tally.known_failures;
    return fmt::format(
        "<tr><td><a href=\"#case-{}\">{}</a></td><td>{}</td><td class=\"n\">{}</td>"
        "<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{:.0f} s</td></tr>\n",
        escape(c.name), escape(c.title), result.skipped.empty() ? "" : "skipped", tally.passed,
        failed > 0 ? fmt::format("<span class=\"verdict fail\">{}</span>", failed) : "0", tally.shown,
        result.wall_time);
}

/// What is said of a case beside its numbers: why it fails, why it was not run, what to know.
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

std::string case_html(const CaseResult& result) {
    const Case& c = result.validation_case;
    std::string html = fmt::format("<section class=\"case\" id=\"case-{}\">\n<h2>{}<small>{}</small></h2>\n<p>{}</p>\n",
                                   escape(c.name), escape(c.title), escape(c.name), escape(c.description));
    std::string list;
    for (const std::string& remark : remarks(result)) list += "<li>" + escape(remark) + "</li>\n";
    if (!list.empty()) html += "<ul>\n" + list + "</ul>\n";
    html +=
        "<div class=\"scroll\"><table class=\"data\"><thead><tr><th>Quantity</th><th class=\"n\">Expected</th>"
        "<th class=\"n\">Computed</th><th class=\"n\">Deviation</th><th class=\"n\">Tolerance</th><th>Source</th>"
        "<th>Result</th></tr></thead><tbody>\n";
    for (const Row& row : result.rows) html += row_html(row);
    html += "</tbody></table></div>\n";
    std::string figures;
    for (const Chart& chart : result.charts) {
        figures += fmt::format("<figure>{}\n<figcaption>{}.</figcaption></figure>\n", chart_svg(chart, false),
                               escape(chart.title));
    }
    if (!figures.empty()) html += "<div class=\"charts\">\n" + figures + "</div>\n";
    return html + "</section>\n";
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

std::string page_html(const std::vector<CaseResult>& results) {
    std::string overview, cases;
    for (const CaseResult& result : results) {
        overview += overview_html(result);
        cases += case_html(result);
    }
    const std::string style = fmt::format("{}\n{}\n{}", validation_page_files::report_css,
                                          validation_page_files::chart_css, validation_page_files::page_css);
    return report::fill(validation_page_files::page_html, {{"version", TALUS_VERSION},
                                                           {"style", style},
                                                           {"date", now_text()},
                                                           {"summary", escape(summary_text(results))},
                                                           {"overview", overview},
                                                           {"legend", escape(legend)},
                                                           {"cases", cases}});
}

Status write_markdown(const std::vector<CaseResult>& results, const std::filesystem::path& file) {
    const std::filesystem::path folder = file.parent_path() / file.stem();
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return Error{fmt::format("{}: cannot make this folder: {}", folder.string(), error.message())};
    std::string text = fmt::format(
        "# Validation\n\nMade by `talus validate --markdown` of talus {} on {}. {}\n\n{}\n\n"
        "| Case | Quantity | Expected | Computed | Deviation | Tolerance | Source | Result |\n"
        "|---|---|---:|---:|---:|---:|---|---|\n",
        TALUS_VERSION, now_text(), summary_text(results), legend);
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
            TALUS_TRY(write_text_file(folder / name, chart_svg(chart, true) + "\n"));
            text += fmt::format("\n![{}]({}/{})\n", markdown_text(chart.title), folder.filename().string(), name);
        }
    }
    return write_text_file(file, text);
}

}  // namespace talus::validate
