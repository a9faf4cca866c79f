#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "publish/engine.hpp"

namespace talus::publish {

/// The built page for published twins: web/src/published.ts, in one script and one style sheet.
struct PageFiles {
    std::string_view script, style;
    std::string_view worker;  ///< runs the engine; needed with one only
    std::string_view loader;  ///< inflates the script; needed in one file only
};

/// What a published twin holds.
struct Content {
    std::string title;  ///< of the scene: text of anybody
    std::string about;  ///< JSON, what the page says of the file: Description of web/src/protocol/recorded.ts
    std::string tape;   ///< Tape::pack()
    std::optional<Engine> engine = {};
    std::string scene = {};  ///< packed, for the engine
};

struct File {
    std::string name, bytes;
};

/// Bytes as characters of a block of the page, seven bits in each: 17 % more, where base64 takes a third more.
[[nodiscard]] std::string text_of_bytes(std::string_view bytes);

/// One page that needs nothing else and reaches nothing: its own policy forbids it.
[[nodiscard]] std::string one_file(const PageFiles& page, const Content& content);

/// The same as files for any web server: index.html and what it loads from beside it.
[[nodiscard]] std::vector<File> folder(const PageFiles& page, const Content& content);

}  // namespace talus::publish
