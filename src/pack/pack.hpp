#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "scene/scene.hpp"

/// A scene in one block of bytes, which a page's engine opens without a file: docs/web-engine.md.
namespace talus::pack {

/// A frame of a recorded run, as it is sent to a page (docs/protocol.md).
struct RecordedFrame {
    double time = 0;  ///< s
    std::string message;
};

/// A picture of the ground from above, over the terrain's extent.
struct Picture {
    std::string type;  ///< "image/jpeg"
    std::string bytes;
};

struct Packed {
    scene::Scene scene;
    std::vector<std::string> overrides{};  ///< that it was loaded with, for its journals
    std::optional<double> latitude{};      ///< degrees, of the terrain's middle; empty: not known
    std::optional<Picture> orthophoto{};
    std::vector<RecordedFrame> recording{};  ///< of a run without changes, by time; empty: none
};

/// The most cells of a terrain and particles that a page has memory for (docs/web-engine.md), and the largest picture.
inline constexpr std::size_t most_cells = 9'000'000, most_particles = 100'000, most_bytes = 256'000'000;

/// Refuses a scene that a page could not hold, with the number that is too large.
[[nodiscard]] Status check_size(const Packed& packed);

/// Paths become names of files: where they lay is nobody's business.
[[nodiscard]] std::string write(const Packed& packed);

/// Errors, each one sentence that begins with `name`: no packed scene, of another version, cut short, damaged, values
/// out of their ranges, what does not fit together, as of check_size().
[[nodiscard]] Result<Packed> read(std::span<const std::byte> bytes, std::string_view name);

/// The same of what the bytes hold once they are checked against their hash and inflated, for tests.
[[nodiscard]] Result<Packed> read_content(std::string_view content, std::string_view name);

}  // namespace talus::pack
