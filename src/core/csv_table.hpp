#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/quantity.hpp"
#include "core/result.hpp"

namespace talus {

struct CsvRow {
    std::size_t line = 0;             ///< in the file, from 1
    std::vector<std::string> fields;  ///< as many as the table has columns
};

/// A table of text: its columns, and its rows without those that are empty.
struct CsvTable {
    std::vector<std::string> columns;
    std::vector<CsvRow> rows;
    Comma comma = Comma::either;  ///< in its numbers: decimal where something else separates the columns
};

/// Reads a table as RFC 4180 has it and as spreadsheets write it: fields separated by comma, semicolon or tab, as its
/// first line has them, quoted where necessary; UTF-8, UTF-16 with a byte order mark, or Windows-1252. Fields that are
/// missing at the end of a row are empty. Errors, with file and line: missing, a folder, over 128 MB, more than
/// `most_rows` rows, more fields than columns, a quote that is not closed or stands within a field.
[[nodiscard]] Result<CsvTable> read_csv_table(const std::string& file, std::size_t most_rows);

}  // namespace talus
