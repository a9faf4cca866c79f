#include "products/text_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include <fmt/format.h>

namespace talus::products {

Status write_text_file(const std::filesystem::path& file, std::string_view text) {
    std::FILE* out = std::fopen(file.c_str(), "wb");
    if (out == nullptr) return Error{fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno))};
    const bool written = std::fwrite(text.data(), 1, text.size(), out) == text.size() && std::fflush(out) == 0;
    int cause = errno;
    const bool closed = std::fclose(out) == 0;
    if (written && closed) return {};
    if (written) cause = errno;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) std::filesystem::remove(file, ignored);
    return Error{fmt::format("{}: cannot be written: {}", file.string(), std::strerror(cause))};
}

}  // namespace talus::products
