#include "core/visible_text.hpp"

#include <cstddef>

namespace talus {
namespace {

/// A character that is not to be seen, and its length in bytes; 0: any other.
struct Hidden {
    unsigned code = 0;
    std::size_t size = 0;
};

Hidden hidden_at(std::string_view text, std::size_t i) {
    const auto byte = [&](std::size_t k) { return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0U; };
    const unsigned lead = byte(0);
    if (lead < 0x20 || lead == 0x7F) return lead == '\n' || lead == '\t' ? Hidden{} : Hidden{lead, 1};
    if (lead == 0xC2 && byte(1) >= 0x80 && byte(1) < 0xA0) return {byte(1), 2};
    if (lead == 0xD8 && byte(1) == 0x9C) return {0x061C, 2};  // Arabic letter mark
    if (lead != 0xE2 || (byte(1) != 0x80 && byte(1) != 0x81)) return {};
    // Marks, embeddings and overrides, isolates (Unicode Standard Annex 9); line and paragraph separators.
    const unsigned code = 0x2000 + (byte(1) - 0x80) * 64 + (byte(2) - 0x80);
    const bool hidden =
        code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
    return hidden ? Hidden{code, 3} : Hidden{};
}

}  // namespace

std::string visible(std::string_view text, std::string_view backslash) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size();) {
        const Hidden hidden = hidden_at(text, i);
        if (hidden.size == 0) {
            out += text[i++];
            continue;
        }
        out.append(backslash).append("u");
        for (int shift = 12; shift >= 0; shift -= 4) out += "0123456789ABCDEF"[hidden.code >> shift & 15];
        i += hidden.size;
    }
    return out;
}

}  // namespace talus
