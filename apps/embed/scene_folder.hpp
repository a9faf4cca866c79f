#pragma once

#include <filesystem>
#include <string>

#include "core/result.hpp"
#include "talus.h"

namespace talus::embed {

/// A scene from arrays as files. Unless it is kept, they go with this object, and the folder is as before.
class SceneFolder {
  public:
    /// `folder` is created if absent, and must be empty. Errors name what is missing or wrong in the arrays.
    [[nodiscard]] static Result<SceneFolder> write(const talus_arrays& arrays, const std::filesystem::path& folder);
    ~SceneFolder();
    SceneFolder(SceneFolder&& other) noexcept;
    SceneFolder& operator=(SceneFolder&&) = delete;
    SceneFolder(const SceneFolder&) = delete;
    SceneFolder& operator=(const SceneFolder&) = delete;

    [[nodiscard]] std::filesystem::path scene_file() const;
    /// A sentence about the files as one about the arrays that they were made from.
    [[nodiscard]] std::string in_words_of_arrays(std::string sentence) const;
    void keep() { temporary_ = false; }

  private:
    SceneFolder(std::filesystem::path folder, bool made) : folder_(std::move(folder)), made_(made) {}

    std::filesystem::path folder_;
    bool made_, temporary_ = true;
};

}  // namespace talus::embed
