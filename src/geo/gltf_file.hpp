#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"

namespace talus::geo {

/// Numbers of a glTF accessor, checked to lie in their buffer.
struct GltfAccessor {
    const char* data = nullptr;
    std::size_t count = 0;       ///< elements
    std::size_t stride = 0;      ///< bytes from one to the next
    std::size_t width = 0;       ///< components of an element
    std::int64_t component = 0;  ///< component type, as numbered by glTF
    bool normalized = false;

    /// A component; element < count, k < width.
    [[nodiscard]] double at(std::size_t element, std::size_t k) const;
    [[nodiscard]] bool holds_indices() const;
};

/// A glTF 2.0 file (Khronos Group 2021, ISO/IEC 12113), as JSON or in the binary container, with its buffers: embedded,
/// or files in its folder or below. Images are ignored, and nothing is fetched from elsewhere. Sizes are checked
/// against the data before they are used.
class GltfFile {
  public:
    [[nodiscard]] static Result<GltfFile> open(const std::string& file);

    [[nodiscard]] const nlohmann::json& root() const { return *root_; }
    /// An entry of one of the file's lists; null if there is none.
    [[nodiscard]] const nlohmann::json* entry(const char* list, std::size_t index) const;
    /// Errors name the accessor or view.
    [[nodiscard]] Result<GltfAccessor> accessor(std::size_t index) const;
    /// Other files that were read with it.
    [[nodiscard]] const std::vector<std::string>& buffer_files() const { return buffer_files_; }

  private:
    struct Buffer {
        std::string own;  ///< what was decoded or read; empty: the binary chunk
        bool binary_chunk = false;
        std::size_t size = 0;
    };

    Status split_container();
    Status check_version() const;
    Status check_extensions() const;
    Status read_buffers();
    Status read_buffer(const nlohmann::json& entry, std::size_t index, const std::string& at);
    Status read_external(const std::string& uri, Buffer& buffer, const std::string& at);
    [[nodiscard]] Result<std::string_view> view(std::size_t index, std::size_t& stride) const;
    [[nodiscard]] std::string_view bytes_of(const Buffer& buffer) const;

    std::string file_, text_;
    std::size_t json_begin_ = 0, json_size_ = 0, chunk_begin_ = 0, chunk_size_ = 0;
    std::unique_ptr<const nlohmann::json> root_;
    std::vector<Buffer> buffers_;
    std::vector<std::string> buffer_files_;
    std::size_t external_bytes_ = 0;
};

/// A member of an object; a null value if it has none.
[[nodiscard]] const nlohmann::json& gltf_member(const nlohmann::json& object, const char* key);

/// A whole number, not negative and below 2^40, so that sums and products of a few stay whole; false if it is not one.
[[nodiscard]] bool gltf_size(const nlohmann::json& value, std::size_t& size);

}  // namespace talus::geo
