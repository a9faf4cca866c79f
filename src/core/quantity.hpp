#pragma once

#include <string_view>

#include "core/result.hpp"

namespace talus {

enum class Dimension { none, length, pressure };

/// What a comma in a number may be.
enum class Comma {
    either,   ///< "1,234" is refused: 1.234 in one country, 1234 in another
    decimal,  ///< as in a table whose columns are separated by something else
};

/// The number in a text that people wrote, as attribute tables and spreadsheets hold it, in m or Pa: "12.5", "12,5",
/// "12 m", "30 ft", "40'", "5'6\"", "500 kPa"; without a unit it is in m or Pa. Errors, the end of a sentence, for all
/// else: a word, a sign of doubt ("~8"), a range, another unit, a comma that may separate thousands.
[[nodiscard]] Result<double> read_quantity(std::string_view text, Dimension dimension, Comma comma = Comma::either);

}  // namespace talus
