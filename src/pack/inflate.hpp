#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/result.hpp"

namespace talus::pack {

/// What a stream in zlib's format (RFC 1950, 1951) holds, of exactly `size` bytes. A reader of its own, so that a
/// page's engine needs no library, and the same bytes are refused everywhere. Memory grows with what has been read,
/// never with what is claimed. Errors are the end of a sentence: "is cut short".
[[nodiscard]] Result<std::string> inflate(std::span<const std::byte> stream, std::size_t size);

}  // namespace talus::pack
