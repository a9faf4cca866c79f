#pragma once

#include <string>

#include "pack/pack.hpp"

namespace talus::pack {

/// What write() compresses, and the file around it: read by read_content() and read().
[[nodiscard]] std::string write_content(const Packed& packed);
[[nodiscard]] std::string enclose(const std::string& content, const std::string& deflated);

}  // namespace talus::pack
