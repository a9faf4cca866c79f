#pragma once

#include <filesystem>
#include <system_error>

namespace talus::cli {

/// talus_out in the current folder, created when needed and removed again if it remains empty.
class DefaultParent {
  public:
    DefaultParent() : made_(std::filesystem::create_directory(name, error_)) {}
    ~DefaultParent() {
        std::error_code not_empty;
        if (made_) std::filesystem::remove(name, not_empty);
    }
    DefaultParent(const DefaultParent&) = delete;
    DefaultParent& operator=(const DefaultParent&) = delete;

    static constexpr const char* name = "talus_out";

  private:
    std::error_code error_;  // ignored: creating the output folder gives the better error message
    bool made_;
};

}  // namespace talus::cli
