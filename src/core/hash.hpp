#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace talus {

/// FNV-1a, 64 bit (Fowler, Noll, Vo 1991): for recognising equal results, not for security.
class StateHash {
  public:
    void add(const void* data, std::size_t bytes) {
        const auto* p = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < bytes; ++i) value_ = (value_ ^ p[i]) * 0x100000001b3ULL;
    }
    template <class T>
    void add(std::span<const T> items) {
        add(items.data(), items.size_bytes());
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// Sixteen lower-case hexadecimal digits.
[[nodiscard]] std::string to_hex(std::uint64_t value);

}  // namespace talus
