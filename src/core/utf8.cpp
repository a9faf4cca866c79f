#include "core/utf8.hpp"

#include <array>
#include <cstdint>

namespace talus {
namespace {

/// The bytes of Windows-1252 that are not those of Latin-1, from 0x80; 0: it has none there.
constexpr std::array<std::uint16_t, 32> windows_1252 = {0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                        0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017D, 0,
                                                        0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                        0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};
constexpr std::uint32_t replacement = 0xFFFD;

void append(std::string& out, std::uint32_t code) {
    const auto put = [&](std::uint32_t byte) { out += static_cast<char>(static_cast<unsigned char>(byte)); };
    const auto rest = [&](int shift) { put(0x80 | (code >> shift & 0x3F)); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xC0 | code >> 6);
        rest(0);
    } else if (code < 0x10000) {
        put(0xE0 | code >> 12);
        rest(6);
        rest(0);
    } else {
        put(0xF0 | code >> 18);
        rest(12);
        rest(6);
        rest(0);
    }
}

/// Length of the character that begins at `i`, 0 if none does. `cut`: the text ends within it.
std::size_t character_at(std::string_view text, std::size_t i, bool& cut) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[i + k]); };
    const unsigned lead = byte(0);
    if (lead < 0x80) return 1;
    const std::size_t length = lead >= 0xC2 && lead <= 0xDF   ? 2
                               : lead >= 0xE0 && lead <= 0xEF ? 3
                               : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                              : 0;
    if (length == 0) return 0;
    for (std::size_t k = 1; k < length; ++k) {
        if (i + k >= text.size()) {
            cut = true;
            return 0;
        }
        // Longer forms than necessary, surrogates and codes above U+10FFFF show in the second byte.
        const unsigned low = k > 1 ? 0x80U : lead == 0xE0 ? 0xA0U : lead == 0xF0 ? 0x90U : 0x80U;
        const unsigned high = k > 1 ? 0xBFU : lead == 0xED ? 0x9FU : lead == 0xF4 ? 0x8FU : 0xBFU;
        if (byte(k) < low || byte(k) > high) return 0;
    }
    return length;
}

/// As `invalid_utf8`; `cut`: what is invalid there is a character that the end of the text has cut in two.
std::size_t find_invalid(std::string_view text, bool& cut) {
    cut = false;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = character_at(text, i, cut);
        if (length == 0) return i;
        i += length;
    }
    return std::string_view::npos;
}

std::string from_windows_1252(std::string_view text) {
    std::string out;
    out.reserve(text.size() + text.size() / 8);
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const std::uint32_t code = byte >= 0x80 && byte < 0xA0 ? windows_1252[byte - 0x80U] : byte;
        append(out, code == 0 && byte != 0 ? replacement : code);
    }
    return out;
}

std::string from_utf16(std::string_view bytes, bool big_endian) {
    std::string out;
    out.reserve(bytes.size());
    const auto unit = [&](std::size_t i) {
        const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
        return static_cast<std::uint32_t>(big_endian ? first << 8 | second : second << 8 | first);
    };
    std::size_t i = 0;
    for (; i + 1 < bytes.size(); i += 2) {
        std::uint32_t code = unit(i);
        if (code >= 0xD800 && code < 0xE000) {
            const std::uint32_t low = code < 0xDC00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
            if (low >= 0xDC00 && low < 0xE000) {
                code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
                i += 2;
            } else {
                code = replacement;
            }
        }
        append(out, code);
    }
    if (i < bytes.size()) append(out, replacement);
    return out;
}

}  // namespace

std::size_t invalid_utf8(std::string_view text) {
    bool cut = false;
    return find_invalid(text, cut);
}

std::string to_utf8(std::string_view text) {
    bool cut = false;
    const std::size_t invalid = find_invalid(text, cut);
    if (invalid == std::string_view::npos) return std::string(text);
    // A last byte such as the E9 of "Café" in Latin-1 also looks cut: only what has other characters of several bytes
    // is UTF-8.
    const std::string_view whole = text.substr(0, invalid);
    for (const char c : whole) {
        if (cut && static_cast<unsigned char>(c) >= 0x80) return std::string(whole);
    }
    return from_windows_1252(text);
}

std::string file_to_utf8(std::string_view bytes) {
    if (bytes.starts_with("\xFF\xFE")) return from_utf16(bytes.substr(2), false);
    if (bytes.starts_with("\xFE\xFF")) return from_utf16(bytes.substr(2), true);
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    return to_utf8(bytes);
}

}  // namespace talus
