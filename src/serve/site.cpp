#include "serve/site.hpp"

#include <cstdint>
#include <cstring>
#include <utility>
#include <zlib.h>

#include "serve/site_archive.hpp"

namespace talus::serve {
namespace {

const char* type_of(std::string_view name) {
    constexpr std::pair<const char*, const char*> types[] = {{".html", "text/html; charset=utf-8"},
                                                             {".js", "text/javascript; charset=utf-8"},
                                                             {".mjs", "text/javascript; charset=utf-8"},
                                                             {".css", "text/css; charset=utf-8"},
                                                             {".json", "application/json"},
                                                             {".svg", "image/svg+xml"},
                                                             {".png", "image/png"},
                                                             {".jpg", "image/jpeg"},
                                                             {".webp", "image/webp"},
                                                             {".ico", "image/x-icon"},
                                                             {".woff2", "font/woff2"},
                                                             {".txt", "text/plain; charset=utf-8"},
                                                             {".webmanifest", "application/manifest+json"},
                                                             {".wasm", "application/wasm"}};
    for (const auto& [ending, type] : types) {
        if (name.ends_with(ending)) return type;
    }
    return "application/octet-stream";
}

/// None: it would not be smaller.
Bytes gzip(std::string_view content) {
    z_stream stream{};
    constexpr int gzip_header = 16;
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + gzip_header, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
        return nullptr;
    }
    std::string packed(deflateBound(&stream, content.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));  // zlib does not write to it
    stream.avail_in = static_cast<uInt>(content.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    const bool complete = deflate(&stream, Z_FINISH) == Z_STREAM_END;
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    if (!complete || packed.size() + packed.size() / 8 > content.size()) return nullptr;
    return std::make_shared<const std::string>(std::move(packed));
}

}  // namespace

Site::Site() {
    for (const ArchivedFile& file : site_archive()) {
        if (file.name.starts_with("published/")) continue;  // of published twins: no browser asks for it
        File made;
        made.type = type_of(file.name);
        made.content = std::make_shared<const std::string>(file.content);
        made.gzipped = gzip(file.content);
        made.for_ever = file.name.starts_with("assets/");
        files_.emplace("/" + std::string(file.name), std::move(made));
    }
}

const Site::File* Site::find(std::string_view path) const {
    const auto found = files_.find(path == "/" ? "/index.html" : path);
    return found == files_.end() ? nullptr : &found->second;
}

}  // namespace talus::serve
