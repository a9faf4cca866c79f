#pragma once

/// What the program uses of zlib to send frames: here they only change hands within a page, so that they are stored as
/// they are, in the format of zlib.

#include <cstddef>
#include <cstdint>
#include <cstring>

using Bytef = unsigned char;
using uInt = unsigned;
using uLong = unsigned long;

inline constexpr int Z_BEST_SPEED = 1, Z_DEFLATED = 8, MAX_WBITS = 15, MAX_MEM_LEVEL = 9, Z_FINISH = 4,
                     Z_STREAM_END = 1;
inline constexpr int Z_DEFAULT_STRATEGY = 0, Z_FILTERED = 1, Z_HUFFMAN_ONLY = 2, Z_RLE = 3;

struct z_stream {
    Bytef* next_in = nullptr;
    uInt avail_in = 0;
    Bytef* next_out = nullptr;
    uInt avail_out = 0;
    uLong total_out = 0;
};

inline int deflateInit2(z_stream*, int, int, int, int, int) {
    return 0;
}
inline int deflateEnd(z_stream*) {
    return 0;
}

inline constexpr std::size_t longest_stored = 65535;

inline uLong deflateBound(z_stream*, std::size_t size) {
    return size + 5 * (size / longest_stored + 1) + 6;
}

/// All of it at once, as Z_FINISH asks for.
inline int deflate(z_stream* stream, int) {
    Bytef* out = stream->next_out;
    *out++ = 0x78;
    *out++ = 0x01;
    std::size_t rest = stream->avail_in;
    const Bytef* in = stream->next_in;
    std::uint32_t a = 1, b = 0;  // Adler-32
    do {
        const std::size_t size = rest < longest_stored ? rest : longest_stored;
        rest -= size;
        *out++ = rest == 0 ? 1 : 0;
        *out++ = static_cast<Bytef>(size);
        *out++ = static_cast<Bytef>(size >> 8);
        *out++ = static_cast<Bytef>(~size);
        *out++ = static_cast<Bytef>(~size >> 8);
        if (size > 0) std::memcpy(out, in, size);
        for (std::size_t i = 0; i < size;) {
            const std::size_t end = i + 5552 < size ? i + 5552 : size;  // before the sums could overflow
            for (; i < end; ++i) {
                a += in[i];
                b += a;
            }
            a %= 65521;
            b %= 65521;
        }
        out += size;
        in += size;
    } while (rest > 0);
    for (const std::uint32_t part : {b >> 8, b, a >> 8, a}) *out++ = static_cast<Bytef>(part);
    stream->total_out = static_cast<uLong>(out - stream->next_out);
    stream->avail_out -= static_cast<uInt>(stream->total_out);
    stream->next_out = out;
    stream->avail_in = 0;
    return Z_STREAM_END;
}
