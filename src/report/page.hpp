#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

/// Pages from templates and data. The templates are Mustache (https://mustache.github.io): they contain the text and
/// all HTML, the data the values.
namespace talus::report {

using Json = nlohmann::ordered_json;

/// The template filled from `data`; what it includes by {{> name}} is src/report/templates/name.html.
///   {{value}}     text, escaped; {{{value}}} as it is
///   {{value|f2}}  a number as formatted() prints it
///   {{{value|css}}}  a text within the quotes of a string of CSS
///   {{figure}}    the next figure's number, {{page_style}} and {{page_script}} those of all reports
/// A chart of chart_json() is there as its drawing {{{svg}}}; a table of table.hpp as the partial `table` wants it.
/// Null, false, an empty text or list: {{#value}} is skipped. A name that the data lack is a bug (asserted).
[[nodiscard]] std::string render(std::string_view page_template, const Json& data);

}  // namespace talus::report
