#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "publish/page.hpp"
#include "serve/recorder.hpp"
#include "serve/session_file.hpp"

namespace talus::serve {

/// A browser decodes the whole file before it shows anything: more is refused.
inline constexpr std::size_t largest_twin = 150'000'000;

/// Of all frames of a scenario beside an engine, so that the file stays small enough to send: who wants to look closer
/// runs it again.
inline constexpr std::size_t frame_bytes_with_engine = 720'000;

/// A scene, or a session of it, to be published.
struct ToPublish {
    std::shared_ptr<const scene::Scene> scene;
    std::vector<std::string> overrides = {};      ///< that the scene was loaded with
    std::vector<OpeningScenario> scenarios = {};  ///< of a saved session, as far as they went; none: the scene is run
    std::vector<Overlay> overlays = {};           ///< of the session
    std::filesystem::path folder = {};            ///< an existing one for temporary files
    RecordOptions recording = {};
    bool engine = false;  ///< with the engine, so that a reader can change the run
};

/// Whether this program carries the engine, and can pack a scene for it.
[[nodiscard]] bool carries_engine();

/// What a published twin holds, for the one who publishes it.
struct Published {
    publish::PageFiles page;
    publish::Content content;
    std::vector<std::string> contents;  ///< a line each: runs, data, orthophoto
    std::string hash;                   ///< of scenario A at its end, hexadecimal
};

/// Opens the scene without a server, runs it unless it is a session, and records it. Errors: the scene cannot be run, a
/// fault, stopped, larger than largest_twin, no page in this program.
[[nodiscard]] Result<Published> publish(ToPublish wanted, const SayShare& say);

/// Error: a recording of so many bytes is larger than that.
[[nodiscard]] Status check_twin_size(std::size_t bytes);

/// What the page says of its file, as JSON.
[[nodiscard]] std::string describe_twin(const scene::Scene& scene, bool engine);

}  // namespace talus::serve
