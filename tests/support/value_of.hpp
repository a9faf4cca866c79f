#pragma once

#include <stdexcept>
#include <utility>

#include "core/result.hpp"

namespace talus::test {

/// The value of a Result, without which a test cannot go on.
template <class T>
T value_of(Result<T> result) {
    if (!result) throw std::runtime_error(result.error().message);
    return *std::move(result);
}

}  // namespace talus::test
