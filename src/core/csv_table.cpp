#include "core/csv_table.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

#include "core/input_file.hpp"
#include "core/try.hpp"
#include "core/utf8.hpp"

namespace talus {
namespace {

constexpr std::size_t largest_file = 128 << 20;  // bytes

Result<std::string> read_text(const std::string& file) {
    TALUS_TRY(check_input_file(file));
    std::ifstream in(file, std::ios::binary);
    std::error_code code;
    if (!in || std::filesystem::is_directory(file, code)) return Error{file + ": no such file, or it cannot be opened"};
    std::string bytes;
    char block[65536];
    while (in.read(block, sizeof block), in.gcount() > 0) {
        bytes.append(block, static_cast<std::size_t>(in.gcount()));
        if (bytes.size() > largest_file) return Error{file + ": is larger than 128 MB"};
    }
    return file_to_utf8(bytes);
}

std::string at_line(const std::string& file, std::size_t line, const std::string& what) {
    return file + ":" + std::to_string(line) + ": " + what;
}

std::string trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return "";
    return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

/// The character that separates the columns, by the first line: the most frequent one outside quotes.
char separator_of(std::string_view text) {
    std::size_t commas = 0, semicolons = 0, tabs = 0;
    bool quoted = false;
    for (const char c : text.substr(0, text.find('\n'))) {
        if (c == '"') quoted = !quoted;
        if (quoted) continue;
        commas += c == ',' ? 1 : 0;
        semicolons += c == ';' ? 1 : 0;
        tabs += c == '\t' ? 1 : 0;
    }
    const std::size_t most = std::max({commas, semicolons, tabs});
    return most == commas ? ',' : most == semicolons ? ';' : '\t';
}

/// Takes the records of a text one after the other.
class Records {
  public:
    Records(const std::string& file, std::string_view text, char separator)
        : file_(file), text_(text), separator_(separator) {}

    /// None after the last.
    Result<std::optional<CsvRow>> next() {
        if (at_ >= text_.size()) return std::optional<CsvRow>();
        CsvRow row;
        row.line = line_;
        for (bool more = true; more;) {
            TALUS_ASSIGN(std::string field, take_field());
            row.fields.push_back(std::move(field));
            more = at_ < text_.size() && text_[at_] == separator_;
            if (at_ >= text_.size()) break;
            if (text_[at_] == '\n') ++line_;
            ++at_;
        }
        return std::optional(std::move(row));
    }

  private:
    /// The field at `at_`, which then stands on what ends it.
    Result<std::string> take_field() {
        while (at_ < text_.size() && text_[at_] == ' ') ++at_;
        if (at_ >= text_.size() || text_[at_] != '"') {
            const std::size_t first = at_;
            while (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n') ++at_;
            return trimmed(text_.substr(first, at_ - first));
        }
        const std::size_t opened = line_;
        std::string field;
        for (++at_; at_ < text_.size(); ++at_) {
            if (text_[at_] == '\n') ++line_;
            if (text_[at_] != '"') {
                field += text_[at_];
            } else if (text_.substr(at_ + 1).starts_with('"')) {
                field += text_[at_++];
            } else {
                break;
            }
        }
        if (at_ >= text_.size()) return Error{at_line(file_, opened, "a quote is not closed")};
        ++at_;
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\r')) ++at_;
        if (at_ < text_.size() && text_[at_] != separator_ && text_[at_] != '\n') {
            return Error{at_line(file_, line_, "behind the closing quote of a field comes more text")};
        }
        return trimmed(field);
    }

    const std::string& file_;
    std::string_view text_;
    char separator_;
    std::size_t at_ = 0, line_ = 1;
};

bool is_empty(const std::string& field) {
    return field.empty();
}

}  // namespace

Result<CsvTable> read_csv_table(const std::string& file, std::size_t most_rows) {
    TALUS_ASSIGN(const std::string text, read_text(file));
    const char separator = separator_of(text);
    Records records(file, text, separator);
    CsvTable table;
    if (separator != ',') table.comma = Comma::decimal;
    TALUS_ASSIGN(std::optional<CsvRow> header, records.next());
    if (header) table.columns = std::move(header->fields);
    const auto columns = static_cast<std::ptrdiff_t>(table.columns.size());
    for (;;) {
        TALUS_ASSIGN(std::optional<CsvRow> row, records.next());
        if (!row) break;
        std::vector<std::string>& fields = row->fields;
        if (std::all_of(fields.begin(), fields.end(), is_empty)) continue;
        if (table.rows.size() >= most_rows)
            return Error{file + ": has more than " + std::to_string(most_rows) + " rows"};
        // Spreadsheets pad rows with empty fields.
        if (std::ssize(fields) > columns && !std::all_of(fields.begin() + columns, fields.end(), is_empty)) {
            return Error{at_line(file, row->line,
                                 "has " + std::to_string(fields.size()) + " fields, and the first line names " +
                                     std::to_string(columns) +
                                     " columns; a decimal comma needs quotes, or semicolons between the columns")};
        }
        fields.resize(table.columns.size());
        table.rows.push_back(std::move(*row));
    }
    return Result<CsvTable>(std::move(table));
}

}  // namespace talus
