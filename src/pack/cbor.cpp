#include "pack/cbor.hpp"

#include <bit>
#include <cstring>

namespace talus::pack {

static_assert(std::endian::native == std::endian::little, "typed arrays are written as the machine holds them");

void CborWriter::head(unsigned kind, std::uint64_t value) {
    int bytes = 8;
    if (value < 24) {
        byte(kind << 5 | static_cast<unsigned>(value));
        return;
    }
    if (value <= 0xff) {
        byte(kind << 5 | 24);
        bytes = 1;
    } else if (value <= 0xffff) {
        byte(kind << 5 | 25);
        bytes = 2;
    } else if (value <= 0xffffffff) {
        byte(kind << 5 | 26);
        bytes = 4;
    } else {
        byte(kind << 5 | 27);
    }
    for (int i = bytes - 1; i >= 0; --i) byte(static_cast<unsigned>(value >> (8 * i) & 0xff));
}

void CborWriter::number(double value) {
    byte(0xfb);
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    for (int i = 7; i >= 0; --i) byte(static_cast<unsigned>(bits >> (8 * i) & 0xff));
}

void CborWriter::text(std::string_view value) {
    head(3, value.size());
    add(value.data(), value.size());
}

void CborWriter::array(ArrayTag tag, const void* data, std::size_t bytes) {
    head(6, static_cast<unsigned>(tag));
    head(2, bytes);
    add(data, bytes);
}

std::string_view CborReader::take(std::uint64_t bytes) {
    if (bytes > rest_.size()) {
        fail();
        return {};
    }
    const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(bytes));
    rest_.remove_prefix(taken.size());
    return taken;
}

std::uint64_t CborReader::head(unsigned kind) {
    const std::string_view first = take(1);
    if (first.empty()) return 0;
    const auto initial = static_cast<unsigned char>(first.front());
    const unsigned size = initial & 31U;
    if (initial >> 5U != kind || size > 27) {
        fail();
        return 0;
    }
    if (size < 24) return size;
    std::uint64_t value = 0;
    for (const char c : take(std::uint64_t{1} << (size - 24))) value = value << 8 | static_cast<unsigned char>(c);
    return value;
}

std::uint64_t CborReader::whole() {
    return head(0);
}

std::int64_t CborReader::integer() {
    const bool negative = !rest_.empty() && static_cast<unsigned char>(rest_.front()) >> 5U == 1;
    const std::uint64_t value = head(negative ? 1 : 0);
    if (value >> 63U != 0) {
        fail();
        return 0;
    }
    return negative ? ~static_cast<std::int64_t>(value) : static_cast<std::int64_t>(value);
}

double CborReader::number() {
    const std::string_view bytes = take(9);
    if (bytes.empty() || static_cast<unsigned char>(bytes.front()) != 0xfb) {
        fail();
        return 0;
    }
    std::uint64_t bits = 0;
    for (const char c : bytes.substr(1)) bits = bits << 8 | static_cast<unsigned char>(c);
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

bool CborReader::boolean() {
    const std::string_view byte = take(1);
    const unsigned value = byte.empty() ? 0 : static_cast<unsigned char>(byte.front());
    if (value != 0xf4 && value != 0xf5) fail();
    return value == 0xf5;
}

bool CborReader::null() {
    if (rest_.empty() || static_cast<unsigned char>(rest_.front()) != 0xf6) return false;
    rest_.remove_prefix(1);
    return true;
}

std::string_view CborReader::text() {
    return take(head(3));
}

std::size_t CborReader::list() {
    const std::uint64_t count = head(4);
    if (count > rest_.size()) fail();
    return failed_ ? 0 : static_cast<std::size_t>(count);
}

void CborReader::map(std::size_t count) {
    if (head(5) != count) fail();
}

std::string_view CborReader::array(ArrayTag tag, std::size_t element) {
    if (head(6) != static_cast<unsigned>(tag)) fail();
    const std::string_view bytes = take(head(2));
    if (bytes.size() % element != 0) fail();
    return failed_ ? std::string_view() : bytes;
}

}  // namespace talus::pack
