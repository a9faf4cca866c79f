#include "pack/inflate.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/try.hpp"

namespace talus::pack {
namespace {

constexpr int longest_code = 15;

/// Bits of a stream, the lowest of each byte first. Past the end they are 0, and ended() is true.
class Bits {
  public:
    explicit Bits(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::uint32_t take(int count) {
        while (kept_ < count) {
            if (at_ < bytes_.size()) {
                held_ |= std::uint64_t{std::to_integer<std::uint8_t>(bytes_[at_])} << kept_;
            } else {
                ++missing_;
            }
            ++at_;
            kept_ += 8;
        }
        const auto value = static_cast<std::uint32_t>(held_ & ((std::uint64_t{1} << count) - 1));
        held_ >>= count;
        kept_ -= count;
        return value;
    }
    void to_whole_byte() { static_cast<void>(take(kept_ % 8)); }
    [[nodiscard]] bool ended() const { return missing_ > static_cast<std::size_t>(kept_ / 8); }
    /// Bytes that no bit was taken of.
    [[nodiscard]] std::size_t left() const {
        const std::size_t used = at_ - static_cast<std::size_t>(kept_ / 8);
        return used >= bytes_.size() ? 0 : bytes_.size() - used;
    }

  private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0, missing_ = 0;
    std::uint64_t held_ = 0;
    int kept_ = 0;
};

/// A canonical Huffman code: symbols in the order of their codes.
class Code {
  public:
    /// False: more codes than there can be.
    [[nodiscard]] bool set(std::span<const std::uint8_t> lengths) {
        count_ = {};
        for (const std::uint8_t length : lengths) ++count_[length];
        count_[0] = 0;
        int free = 1;
        for (int length = 1; length <= longest_code; ++length) {
            free = 2 * free - count_[static_cast<std::size_t>(length)];
            if (free < 0) return false;
        }
        std::array<std::uint16_t, longest_code + 2> next{};
        for (std::size_t length = 1; length <= longest_code; ++length) {
            next[length + 1] = static_cast<std::uint16_t>(next[length] + count_[length]);
        }
        for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
            if (lengths[symbol] > 0) symbols_[next[lengths[symbol]]++] = static_cast<std::uint16_t>(symbol);
        }
        return true;
    }
    /// Negative: the bits are no code.
    [[nodiscard]] int read(Bits& bits) const {
        int code = 0, first = 0, index = 0;
        for (std::size_t length = 1; length <= longest_code; ++length) {
            code |= static_cast<int>(bits.take(1));
            const int count = count_[length];
            if (code - count < first) return symbols_[static_cast<std::size_t>(index + code - first)];
            index += count;
            first = 2 * (first + count);
            code *= 2;
        }
        return -1;
    }

  private:
    std::array<std::uint16_t, longest_code + 1> count_{};
    std::array<std::uint16_t, 288> symbols_{};
};

struct Codes {
    Code symbols, distances;
};

const char* const damaged = "is damaged: its compressed data make no sense";

Result<Codes> fixed_codes() {
    std::array<std::uint8_t, 288> lengths{};
    std::fill(lengths.begin(), lengths.begin() + 144, std::uint8_t{8});
    std::fill(lengths.begin() + 144, lengths.begin() + 256, std::uint8_t{9});
    std::fill(lengths.begin() + 256, lengths.begin() + 280, std::uint8_t{7});
    std::fill(lengths.begin() + 280, lengths.end(), std::uint8_t{8});
    std::array<std::uint8_t, 30> distances{};
    distances.fill(5);
    Codes codes;
    if (!codes.symbols.set(lengths) || !codes.distances.set(distances)) return Error{damaged};
    return codes;
}

Result<Codes> read_codes(Bits& bits) {
    const std::size_t symbols = bits.take(5) + 257, distances = bits.take(5) + 1, described = bits.take(4) + 4;
    if (symbols > 286 || distances > 30) return Error{damaged};
    constexpr std::array<std::uint8_t, 19> order{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    std::array<std::uint8_t, 19> of_lengths{};
    for (std::size_t i = 0; i < described; ++i) of_lengths[order[i]] = static_cast<std::uint8_t>(bits.take(3));
    Code code;
    if (!code.set(of_lengths)) return Error{damaged};

    std::array<std::uint8_t, 286 + 30> lengths{};
    for (std::size_t i = 0; i < symbols + distances;) {
        const int symbol = code.read(bits);
        if (symbol < 0 || bits.ended()) return Error{damaged};
        if (symbol < 16) {
            lengths[i++] = static_cast<std::uint8_t>(symbol);
            continue;
        }
        if (symbol == 16 && i == 0) return Error{damaged};
        const std::uint8_t repeated = symbol == 16 ? lengths[i - 1] : std::uint8_t{0};
        const std::size_t times = symbol == 16 ? 3 + bits.take(2) : symbol == 17 ? 3 + bits.take(3) : 11 + bits.take(7);
        if (i + times > symbols + distances) return Error{damaged};
        for (std::size_t k = 0; k < times; ++k) lengths[i++] = repeated;
    }
    const std::span all(lengths);
    Codes codes;
    if (!codes.symbols.set(all.first(symbols)) || !codes.distances.set(all.subspan(symbols, distances))) {
        return Error{damaged};
    }
    return codes;
}

Status read_stored(Bits& bits, std::size_t size, std::string& out) {
    bits.to_whole_byte();
    const std::uint32_t count = bits.take(16), check = bits.take(16);
    if (bits.ended()) return Error{"is cut short"};
    if ((count ^ check) != 0xffff || count > size - out.size()) return Error{damaged};
    if (count > bits.left()) return Error{"is cut short"};
    for (std::uint32_t i = 0; i < count; ++i) out.push_back(static_cast<char>(bits.take(8)));
    return {};
}

Status read_block(Bits& bits, const Codes& codes, std::size_t size, std::string& out) {
    constexpr std::array<std::uint16_t, 29> bases{3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                                  31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
    constexpr std::array<std::uint8_t, 29> extra{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
    while (true) {
        const int symbol = codes.symbols.read(bits);
        if (bits.ended()) return Error{"is cut short"};
        if (symbol < 0 || symbol > 285) return Error{damaged};
        if (symbol == 256) return {};
        if (symbol < 256) {
            if (out.size() == size) return Error{damaged};
            out.push_back(static_cast<char>(symbol));
            continue;
        }
        const auto k = static_cast<std::size_t>(symbol - 257);
        const std::size_t length = bases[k] + bits.take(extra[k]);
        const int step = codes.distances.read(bits);
        if (step < 0 || step > 29) return Error{damaged};
        const int more = step < 4 ? 0 : step / 2 - 1;
        const std::size_t base =
            step < 4 ? static_cast<std::size_t>(step) + 1
                     : (std::size_t{2} + static_cast<std::size_t>(step % 2)) * (std::size_t{1} << more) + 1;
        const std::size_t distance = base + bits.take(more);
        if (bits.ended()) return Error{"is cut short"};
        if (distance > out.size() || length > size - out.size()) return Error{damaged};
        for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - distance]);
    }
}

std::uint32_t adler32(const std::string& text) {
    std::uint32_t a = 1, b = 0;
    for (const char c : text) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    return b << 16 | a;
}

}  // namespace

Result<std::string> inflate(std::span<const std::byte> stream, std::size_t size) {
    if (stream.size() < 2) return Error{"is cut short"};
    const auto method = std::to_integer<unsigned>(stream[0]), flags = std::to_integer<unsigned>(stream[1]);
    if ((method & 15U) != 8 || (method * 256 + flags) % 31 != 0 || (flags & 32U) != 0) return Error{damaged};
    Bits bits(stream.subspan(2));
    std::string out;
    TALUS_ASSIGN(const Codes fixed, fixed_codes());
    bool last = false;
    while (!last) {
        last = bits.take(1) == 1;
        const std::uint32_t kind = bits.take(2);
        if (bits.ended()) return Error{"is cut short"};
        if (kind == 0) {
            TALUS_TRY(read_stored(bits, size, out));
        } else if (kind == 1) {
            TALUS_TRY(read_block(bits, fixed, size, out));
        } else if (kind == 2) {
            TALUS_ASSIGN(const Codes codes, read_codes(bits));
            TALUS_TRY(read_block(bits, codes, size, out));
        } else {
            return Error{damaged};
        }
    }
    bits.to_whole_byte();
    std::uint32_t sum = 0;
    for (int i = 0; i < 4; ++i) sum = sum << 8 | bits.take(8);
    if (bits.ended()) return Error{"is cut short"};
    if (out.size() != size || bits.left() > 0 || sum != adler32(out)) return Error{damaged};
    return out;
}

}  // namespace talus::pack
