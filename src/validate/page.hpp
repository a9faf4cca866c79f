#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "report/chart.hpp"
#include "validate/suite.hpp"

/// The validation table with the plots of every case, for people.
namespace talus::validate {

/// A case's chart as reports draw it.
[[nodiscard]] report::Chart drawing_of(const Chart& chart);

/// The content of the page as data (docs/results.md).
[[nodiscard]] report::Json page_data(const std::vector<CaseResult>& results);
/// A self-contained page, from page_data().
[[nodiscard]] std::string page_html(const report::Json& data);

/// Writes `file` as Markdown and the plots as SVG files into a folder of the same name beside it, without its ending.
/// Errors: a file or the folder cannot be written.
[[nodiscard]] Status write_markdown(const std::vector<CaseResult>& results, const std::filesystem::path& file);

}  // namespace talus::validate
