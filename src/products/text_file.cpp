#include "products/text_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "core/try.hpp"

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

Status replace_text_file(const std::filesystem::path& file, std::string_view text) {
    const std::filesystem::path unfinished =
        file.parent_path() / fmt::format(".{}.unfinished-{}", file.filename().string(), getpid());
    TALUS_TRY(write_text_file(unfinished, text));
    std::error_code failed, ignored;
    std::filesystem::rename(unfinished, file, failed);
    if (!failed) return {};
    std::filesystem::remove(unfinished, ignored);
    return Error{fmt::format("{}: cannot be given its name: {}", file.string(), failed.message())};
}

bool is_unfinished_file(const std::filesystem::path& file) {
    const std::string name = file.filename().string();
    return name.starts_with('.') && name.find(".unfinished-") != std::string::npos;
}

}  // namespace talus::products
