#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/number_or_null.hpp"
#include "report/number_text.hpp"
#include "validate/suite.hpp"

namespace talus::validate {
namespace {

constexpr std::size_t column_count = 8;
constexpr std::size_t longest_source = 44;  // on a terminal; files have it all
using Cells = std::array<std::string, column_count>;

/// Characters, not bytes, of UTF-8.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string number(double value) {
    if (!std::isfinite(value)) return "-";
    return fmt::format("{:.4g}", value);
}

std::string name_of(Comparison comparison) {
    switch (comparison) {
        case Comparison::at_most:
            return "at_most";
        case Comparison::at_least:
            return "at_least";
        case Comparison::near:
            break;
    }
    return "near";
}

std::string name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::pass:
            return "pass";
        case Verdict::fail:
            return "fail";
        case Verdict::known_failure:
            return "known_failure";
        case Verdict::shown:
            return "shown";
        case Verdict::skipped:
            break;
    }
    return "skipped";
}

}  // namespace

std::string verdict_text(Verdict verdict) {
    switch (verdict) {
        case Verdict::pass:
            return "pass";
        case Verdict::fail:
            return "FAIL";
        case Verdict::known_failure:
            return "FAIL (known)";
        case Verdict::shown:
            return "shown";
        case Verdict::skipped:
            break;
    }
    return "skipped";
}

std::string expected_text(const Row& row) {
    const char* bound = row.comparison == Comparison::at_most    ? "at most "
                        : row.comparison == Comparison::at_least ? "at least "
                                                                 : "";
    return bound + number(row.expected);
}

std::string computed_text(const Row& row) {
    if (!std::isfinite(row.computed)) return "-";
    return row.unit == "1" || row.unit.empty() ? number(row.computed) : number(row.computed) + " " + row.unit;
}

std::string deviation_text(const Row& row) {
    if (!std::isfinite(row.relative_error)) return "-";
    if (row.expected == 0) return fmt::format("{:+.3g}", row.relative_error);
    return fmt::format("{:+.1f} %", 100 * row.relative_error);
}

std::string tolerance_text(const Row& row) {
    if (!row.tolerance) return "-";
    if (row.comparison != Comparison::near && *row.tolerance == 0) return "-";  // the bound says it
    if (row.expected == 0) return number(*row.tolerance);
    return fmt::format("{:.3g} %", 100 * *row.tolerance);
}

std::string table_text(const std::vector<CaseResult>& results) {
    std::vector<Cells> lines = {
        {"case", "quantity", "expected", "computed", "deviation", "tolerance", "source", "result"}};
    for (const CaseResult& result : results) {
        for (const Row& row : result.rows) {
            lines.push_back({row.case_name, row.quantity, expected_text(row), computed_text(row), deviation_text(row),
                             tolerance_text(row), report::shortened(row.source, longest_source),
                             verdict_text(row.verdict)});
        }
    }
    std::array<std::size_t, column_count> widths{};
    for (const Cells& cells : lines) {
        for (std::size_t i = 0; i < column_count; ++i) widths[i] = std::max(widths[i], width_of(cells[i]));
    }
    std::string text;
    for (const Cells& cells : lines) {
        for (std::size_t i = 0; i < column_count; ++i) {
            const bool is_number = i >= 2 && i <= 5;
            const std::string padding(widths[i] - width_of(cells[i]), ' ');
            const bool last = i + 1 == column_count;
            text += is_number ? padding + cells[i] : cells[i] + (last ? "" : padding);
            text += last ? "\n" : "  ";
        }
    }
    std::string below;
    for (const CaseResult& result : results) {
        const std::string& name = result.validation_case.name;
        if (!result.skipped.empty()) below += fmt::format("skipped: {}: {}\n", name, result.skipped);
        std::vector<std::string> said;
        for (const Row& row : result.rows) {
            if (row.known_failure.empty() || std::count(said.begin(), said.end(), row.known_failure) > 0) continue;
            if (row.verdict != Verdict::known_failure) continue;
            said.push_back(row.known_failure);
            below += fmt::format("known failure: {}: {}\n", name, row.known_failure);
        }
        for (const Row& row : result.rows) {
            if (row.verdict != Verdict::pass || row.known_failure.empty()) continue;
            below += fmt::format("passes now: {}: {}; take known_failure out of its case file\n", name, row.quantity);
        }
        for (const std::string& note : result.notes) below += fmt::format("note: {}: {}\n", name, note);
    }
    const Tally tally = count(results);
    return text + (below.empty() ? "" : "\n" + below) +
           fmt::format("\n{} passed, {} failed, {} of them known, {} shown, {} skipped\n", tally.passed,
                       tally.failed + tally.known_failures, tally.known_failures, tally.shown, tally.skipped);
}

std::string table_json(const std::vector<CaseResult>& results) {
    auto list = nlohmann::ordered_json::array();
    for (const CaseResult& result : results) {
        for (const Row& row : result.rows) {
            const bool judged = row.verdict != Verdict::shown && row.verdict != Verdict::skipped;
            list.push_back({{"case", row.case_name},
                            {"quantity", row.quantity},
                            {"expected", number_or_null<nlohmann::ordered_json>(row.expected)},
                            {"computed", number_or_null<nlohmann::ordered_json>(row.computed)},
                            {"relative_error", number_or_null<nlohmann::ordered_json>(row.relative_error)},
                            {"tolerance", row.tolerance ? nlohmann::ordered_json(*row.tolerance) : nullptr},
                            {"pass", judged ? nlohmann::ordered_json(row.verdict == Verdict::pass) : nullptr},
                            {"source", row.source},
                            {"unit", row.unit},
                            {"comparison", name_of(row.comparison)},
                            {"verdict", name_of(row.verdict)},
                            {"known_failure", row.known_failure}});
        }
    }
    return list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace talus::validate
