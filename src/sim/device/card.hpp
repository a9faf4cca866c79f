#pragma once

#include <string>

#include "core/result.hpp"

namespace talus::sim::device {

/// A graphics card.
struct Card {
    std::string name;
    std::string driver;  ///< the newest version of CUDA that its driver knows, as "13.0"
};

/// The card that make_cuda_backend() takes: the first that the driver shows. Error: why there is none. Looks once.
[[nodiscard]] const Result<Card>& card();

/// Whether the program can use a card at all: it was built with a CUDA toolkit.
[[nodiscard]] bool built_with_cuda();

}  // namespace talus::sim::device
