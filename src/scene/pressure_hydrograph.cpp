#include "scene/pressure_hydrograph.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "core/csv_table.hpp"
#include "core/quantity.hpp"
#include "core/try.hpp"
#include "scene/parse.hpp"

namespace talus::scene {
namespace {

constexpr std::size_t fewest_rows = 2, most_rows = 1'000'000;
constexpr const char *time_column = "time_s", *ratio_column = "pore_pressure_ratio";
constexpr double latest = 1e7;  ///< s

Result<std::size_t> place_of(const char* column, const CsvTable& csv, const std::string& file) {
    const auto found = std::find(csv.columns.begin(), csv.columns.end(), column);
    if (found == csv.columns.end()) {
        return Error{
            fmt::format("{}:1: there is no column {}; the first line must name {} and {}, separated by commas, "
                        "semicolons or tabs",
                        file, column, time_column, ratio_column)};
    }
    if (std::find(found + 1, csv.columns.end(), column) != csv.columns.end()) {
        return Error{fmt::format("{}:1: there are two columns {}; leave one of them out", file, column)};
    }
    return static_cast<std::size_t>(found - csv.columns.begin());
}

}  // namespace

Result<std::vector<params::PressureSample>> read_pressure_hydrograph(const std::string& file) {
    TALUS_ASSIGN(const CsvTable csv, read_csv_table(file, most_rows));
    TALUS_ASSIGN(const std::size_t time_place, place_of(time_column, csv, file));
    TALUS_ASSIGN(const std::size_t ratio_place, place_of(ratio_column, csv, file));
    std::vector<params::PressureSample> rows;
    for (const CsvRow& line : csv.rows) {
        const auto number = [&](std::size_t place, const char* column, double high) -> Result<double> {
            const std::string& text = line.fields[place];
            const Result<double> value = read_quantity(text, Dimension::none, csv.comma);
            if (value && *value >= 0 && *value <= high) return *value;
            const std::string why = value || text.empty() ? "" : ", because " + value.error().message;
            return Error{fmt::format("{}:{}: {} = \"{}\" is refused{}; it must be a number from 0 to {:.0f}", file,
                                     line.line, column, one_line(text, 40), why, high)};
        };
        TALUS_ASSIGN(const double time, number(time_place, time_column, latest));
        TALUS_ASSIGN(const double ratio, number(ratio_place, ratio_column, 1));
        if (!rows.empty() && !(time > rows.back().time)) {
            return Error{fmt::format("{}:{}: {} = {:.6g} is refused; it must be above that of the row before, {:.6g}",
                                     file, line.line, time_column, time, rows.back().time)};
        }
        rows.push_back({time, ratio});
    }
    if (rows.size() < fewest_rows) {
        return Error{
            fmt::format("{}: has {} rows of values; it must have at least {}", file, rows.size(), fewest_rows)};
    }
    return Result<std::vector<params::PressureSample>>(std::move(rows));
}

}  // namespace talus::scene
