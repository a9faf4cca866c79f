#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "variant_plan.hpp"

namespace talus::cli {
namespace {

/// Three significant digits, without an exponent.
std::string short_number(double value) {
    const double size = std::abs(value);
    return fmt::format("{:.{}f}", value, size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}

std::string value_text(double value) {
    return std::isfinite(value) ? short_number(value) : std::string("not reached");
}

std::string change_text(const run::Change& change, bool judged) {
    if (change.verdict == run::Verdict::not_measured) return "not measured";
    std::string text = value_text(change.value);
    if (std::isfinite(change.percent)) text += fmt::format(" {:+.1f} %", change.percent);
    return text + (judged && change.verdict == run::Verdict::fail ? " !" : "");
}

/// Cells of a row, the first left-aligned, the others right-aligned. Two cells only: a name and a message.
using Cells = std::vector<std::string>;

std::string aligned(const std::vector<Cells>& rows) {
    std::vector<std::size_t> widths;
    for (const Cells& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        const std::size_t in_columns = row.size() == 2 ? 1 : row.size();
        for (std::size_t i = 0; i < in_columns; ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    std::string text;
    for (const Cells& row : rows) {
        std::string line = fmt::format("    {:<{}}", row[0], widths[0]);
        for (std::size_t i = 1; i < row.size(); ++i) {
            line += row.size() == 2 ? "  " + row[i] : fmt::format("  {:>{}}", row[i], widths[i]);
        }
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

/// "front velocity at 121 m" over two lines, the unit below.
void add_heading(const run::Quantity& quantity, Cells& above, Cells& below) {
    std::size_t cut = quantity.name.find(" at ");
    if (cut == std::string::npos) cut = quantity.name.rfind(' ');
    above.push_back(quantity.name.substr(0, cut));
    below.push_back(cut == std::string::npos ? quantity.unit : quantity.name.substr(cut + 1) + ", " + quantity.unit);
}

std::string run_cost_text(const run::RunResult& result) {
    return fmt::format("{:.0f}", result.wall_time);
}

std::string table(const run::Comparison& comparison, const run::RunResult& base) {
    const bool judged = comparison.kind == run::ComparisonKind::convergence;
    Cells above{""}, below{""}, given{"as given"};
    for (const run::Quantity& quantity : comparison.quantities) {
        add_heading(quantity, above, below);
        given.push_back(quantity.not_measured.empty() ? value_text(quantity.base) : "not measured");
    }
    above.emplace_back("wall");
    below.emplace_back("time, s");
    given.push_back(run_cost_text(base));
    if (judged) below.emplace_back("result");
    std::vector<Cells> rows{above, below, given};
    for (const run::Comparison::Row& row : comparison.rows) {
        Cells cells{row.run.variant.name};
        if (row.run.result) {
            for (const run::Change& change : row.changes) cells.push_back(change_text(change, judged));
            cells.push_back(run_cost_text(*row.run.result));
            if (judged) cells.emplace_back(verdict_name(row.verdict()));
        } else {
            cells.push_back("missing: " + row.run.missing);
        }
        rows.push_back(cells);
    }
    return aligned(rows);
}

}  // namespace

std::string comparison_text(const run::Comparison& comparison, const run::RunResult& base) {
    const char* label = comparison.kind == run::ComparisonKind::convergence ? "convergence" : "sensitivity";
    std::string text = fmt::format("  {:<16} {}\n", label, comparison.verdict_text()) + table(comparison, base);
    for (const run::Quantity& quantity : comparison.quantities) {
        if (quantity.not_measured.empty()) continue;
        text += fmt::format("    not measured in the run as given: {} ({})\n", quantity.name, quantity.not_measured);
    }
    return text;
}

}  // namespace talus::cli
