#include "serve/site_archive.hpp"

#include <charconv>
#include <cstddef>

// cmake/pack_site.mjs makes the archive: a line "SIZE NAME" for each file, an empty line, then the contents one after
// the other. The assembler includes it directly: as an array of numbers it would take the compiler seconds.
#ifdef TALUS_SITE_ARCHIVE
__asm__(
    ".section .rodata\n"
    ".global talus_site_begin\n"
    ".global talus_site_end\n"
    "talus_site_begin:\n"
    ".incbin \"" TALUS_SITE_ARCHIVE
    "\"\n"
    "talus_site_end:\n"
    ".previous\n");
extern "C" {
extern const char talus_site_begin[];
extern const char talus_site_end[];
}
#endif

namespace talus::serve {

std::vector<ArchivedFile> site_archive() {
    std::vector<ArchivedFile> files;
#ifdef TALUS_SITE_ARCHIVE
    std::string_view rest(talus_site_begin, static_cast<std::size_t>(talus_site_end - talus_site_begin));
    std::vector<std::size_t> sizes;
    while (!rest.empty() && rest.front() != '\n') {
        const std::size_t blank = rest.find(' '), end = rest.find('\n');
        std::size_t size = 0;
        std::from_chars(rest.data(), rest.data() + blank, size);
        files.push_back({rest.substr(blank + 1, end - blank - 1), {}});
        sizes.push_back(size);
        rest = rest.substr(end + 1);
    }
    rest = rest.substr(1);
    for (std::size_t i = 0; i < files.size(); ++i) {
        files[i].content = rest.substr(0, sizes[i]);
        rest = rest.substr(sizes[i]);
    }
#else
    files.push_back({"index.html",
                     "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>talus</title>\n"
                     "<p>This program was built without the page. The interface for programs works: see "
                     "<a href=\"/api/openapi.json\">/api/openapi.json</a>.</p></html>\n"});
#endif
    return files;
}

}  // namespace talus::serve
