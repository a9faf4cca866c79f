#include "serve/sent_files.hpp"

#include <cstdint>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace talus::serve {

Result<Bytes> SentFiles::read(const std::filesystem::path& file) {
    const std::lock_guard lock(mutex_);  // also while it is read: who comes meanwhile gets that copy
    std::erase_if(sent_, [](const auto& sent) { return sent.second.expired(); });
    if (const auto found = sent_.find(file); found != sent_.end()) {
        if (Bytes bytes = found->second.lock()) return bytes;
    }
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    std::ifstream in(file, std::ios::binary);
    auto text = std::make_shared<std::string>(error ? 0 : size, '\0');
    in.read(text->data(), static_cast<std::streamsize>(text->size()));
    if (error || !in) return Error{fmt::format("{} cannot be read back", file.filename().string())};
    Bytes bytes = std::move(text);
    sent_[file] = bytes;
    return bytes;
}

}  // namespace talus::serve
