#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace talus {

/// Position of the first byte that is not UTF-8 (RFC 3629); npos: there is none.
[[nodiscard]] std::size_t invalid_utf8(std::string_view text);

/// Text from a file as UTF-8. What is not UTF-8 is read as Windows-1252, a superset of Latin-1, which is what offices
/// write that do not say otherwise. A character that a field of fixed length has cut in two is left out.
[[nodiscard]] std::string to_utf8(std::string_view text);

/// A whole text file as UTF-8 without a byte order mark: UTF-16 if its mark says so, otherwise as above.
[[nodiscard]] std::string file_to_utf8(std::string_view bytes);

}  // namespace talus
