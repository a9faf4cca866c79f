#include <string>
#include <string_view>

#include "scene/parse.hpp"

namespace talus::scene {

std::string ParsedScene::at(const std::string& key_path) const {
    auto found = places.find(key_path);
    if (found == places.end()) found = places.find(key_path.substr(0, key_path.rfind('.')));
    return (found == places.end() ? file.string() : found->second) + ": " + key_path;
}

std::string one_line(std::string_view text, std::size_t longest) {
    std::string out;
    for (const char c : text) {
        const bool space = static_cast<unsigned char>(c) <= ' ' || c == '\x7f';
        if (!space || (!out.empty() && out.back() != ' ')) out += space ? ' ' : c;
    }
    if (out.size() > longest) {
        std::size_t end = longest;
        while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xC0) == 0x80) --end;  // not inside a UTF-8 character
        out = out.substr(0, end) + "...";
    }
    return out;
}

}  // namespace talus::scene
