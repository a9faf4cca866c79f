#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// CBOR (RFC 8949) with typed arrays (RFC 8746): the part of it that packed scenes use.
namespace talus::pack {

/// Tags of arrays of numbers, the lowest byte first.
enum class ArrayTag : unsigned { uint8 = 64, uint16 = 69, uint32 = 70, float32 = 85, float64 = 86 };

class CborWriter {
  public:
    void whole(std::uint64_t value) { head(0, value); }
    void negative(std::int64_t value) { head(1, ~static_cast<std::uint64_t>(value)); }
    void number(double value);
    void boolean(bool value) { byte(value ? 0xf5 : 0xf4); }
    void null() { byte(0xf6); }
    void text(std::string_view value);
    void list(std::size_t count) { head(4, count); }
    void map(std::size_t count) { head(5, count); }
    void array(ArrayTag tag, const void* data, std::size_t bytes);
    [[nodiscard]] std::string take() { return std::move(bytes_); }

  private:
    void byte(unsigned value) { bytes_.push_back(static_cast<char>(value)); }
    void head(unsigned kind, std::uint64_t value);
    void add(const void* data, std::size_t bytes) {
        if (bytes > 0) bytes_.append(static_cast<const char*>(data), bytes);
    }

    std::string bytes_;
};

/// Reads what a CborWriter wrote from bytes of any kind. The first thing that is not what was asked for fails the
/// reader; from then on all values are 0 or empty. Nothing is allocated that the bytes do not hold.
class CborReader {
  public:
    /// `bytes` must live as long as this.
    explicit CborReader(std::string_view bytes) : rest_(bytes) {}

    [[nodiscard]] std::uint64_t whole();
    [[nodiscard]] std::int64_t integer();
    [[nodiscard]] double number();
    [[nodiscard]] bool boolean();
    /// Takes a null, if one is next.
    [[nodiscard]] bool null();
    [[nodiscard]] std::string_view text();
    /// The number of elements, each of which needs a byte at least.
    [[nodiscard]] std::size_t list();
    void map(std::size_t count);
    /// The bytes of an array of elements of `element` bytes.
    [[nodiscard]] std::string_view array(ArrayTag tag, std::size_t element);

    void fail() {
        failed_ = true;
        rest_ = {};
    }
    [[nodiscard]] bool failed() const { return failed_; }
    [[nodiscard]] bool complete() const { return !failed_ && rest_.empty(); }

  private:
    [[nodiscard]] std::uint64_t head(unsigned kind);
    [[nodiscard]] std::string_view take(std::uint64_t bytes);

    std::string_view rest_;
    bool failed_ = false;
};

}  // namespace talus::pack
