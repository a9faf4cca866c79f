#pragma once

#include <string_view>
#include <vector>

namespace talus::serve {

struct ArchivedFile {
    std::string_view name;  ///< "index.html", "assets/index-1a2b3c4d.js"
    std::string_view content;
};

/// The built page as embedded in the program; a note instead if it was built without.
[[nodiscard]] std::vector<ArchivedFile> site_archive();

}  // namespace talus::serve
