#pragma once

#include <cmath>

namespace talus {

/// A number for a JSON library's type `Json`, whose text has no NaN and no infinity: null in their place.
template <class Json>
[[nodiscard]] Json number_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

}  // namespace talus
