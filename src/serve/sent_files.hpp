#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/result.hpp"
#include "serve/message.hpp"

namespace talus::serve {

/// Files that do not change once they are there. All who are being sent the same file share one copy of it in memory,
/// which is gone with the last answer. Functions may be called from any thread.
class SentFiles {
  public:
    /// Error: it cannot be read.
    [[nodiscard]] Result<Bytes> read(const std::filesystem::path& file);

  private:
    std::mutex mutex_;
    std::map<std::filesystem::path, std::weak_ptr<const std::string>> sent_;
};

}  // namespace talus::serve
