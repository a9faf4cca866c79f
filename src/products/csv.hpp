#pragma once

#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace talus::products {

/// A table as RFC 4180 has it: comma, point, quotes only where needed, UTF-8.
class Csv {
  public:
    /// `changed`: what was changed during the run, so that its rows are the result of no single setup; a last column
    /// says so in every row. Empty: nothing, and no such column.
    explicit Csv(std::string_view header, std::string_view changed = {})
        : text_(std::string(header) + (changed.empty() ? "\n" : ",changed_on_the_way\n")), changed_(changed) {}

    /// A field; empty where the value is not finite.
    Csv& number(double value) {
        separate();
        if (std::isfinite(value)) text_ += fmt::format("{:.9g}", value);
        return *this;
    }
    Csv& word(std::string_view value) {
        separate();
        if (value.find_first_of(",\"\r\n") == std::string_view::npos) {
            text_ += value;
            return *this;
        }
        text_ += '"';
        for (const char c : value) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
        text_ += '"';
        return *this;
    }
    void end_row() {
        if (!changed_.empty()) word(changed_);
        text_ += '\n';
        first_ = true;
    }
    void row(std::initializer_list<double> values) {
        for (const double value : values) number(value);
        end_row();
    }
    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    void separate() {
        if (!first_) text_ += ',';
        first_ = false;
    }
    std::string text_, changed_;
    bool first_ = true;
};

}  // namespace talus::products
