#pragma once

#include <string>
#include <vector>

#include "bench/measure.hpp"

namespace talus::bench {

/// Two tables for a terminal: the results, and each stage's share of the step.
[[nodiscard]] std::string table_text(const std::vector<Row>& rows);

/// A list of objects, one per row; docs/performance.md says what each key means.
[[nodiscard]] std::string table_json(const std::vector<Row>& rows);

/// One object per row and line, {"event": "row", ...}.
[[nodiscard]] std::string rows_json(const std::vector<Row>& rows);

/// "slab 20000 stress, 2 threads": names what a row measured.
[[nodiscard]] std::string row_name(const Row& row);

}  // namespace talus::bench
