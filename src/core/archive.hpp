#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/// What objects hold, as bytes and back. A class that can be saved names its members once:
///
///     template <class Archive> void keep(Archive& archive) { archive(first_, second_); }
///
/// which an ArchiveWriter and an ArchiveReader both call, so that the two cannot differ. Numbers and structs of numbers
/// are written as the machine holds them: bytes are read by the version of the program that wrote them.
namespace talus {

static_assert(std::endian::native == std::endian::little, "archives are written as the machine holds them");

class ArchiveWriter {
  public:
    static constexpr bool reading = false;

    template <class... T>
    void operator()(T&... values) {
        (put(values), ...);
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

  private:
    template <class T>
    void put(T& value) {
        if constexpr (requires { value.keep(*this); }) {
            value.keep(*this);
        } else {
            static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
            put_bytes(&value, sizeof value);
        }
    }
    template <class T>
    void put(std::vector<T>& values) {
        put_size(values.size());
        if constexpr (std::is_trivially_copyable_v<T>) {
            put_bytes(values.data(), values.size() * sizeof(T));
        } else {
            for (T& value : values) put(value);
        }
    }
    void put(std::string& text) {
        put_size(text.size());
        put_bytes(text.data(), text.size());
    }
    template <class A, class B>
    void put(std::pair<A, B>& value) {
        put(value.first);
        put(value.second);
    }
    void put_size(std::size_t size) {
        const std::uint64_t count = size;
        put_bytes(&count, sizeof count);
    }
    void put_bytes(const void* data, std::size_t size) {
        if (size > 0) bytes_.append(static_cast<const char*>(data), size);
    }

    std::string bytes_;
};

/// Of bytes that may be cut or foreign: then the rest stays as it is, and complete() is false.
class ArchiveReader {
  public:
    static constexpr bool reading = true;

    /// `bytes` must live as long as this.
    explicit ArchiveReader(std::string_view bytes) : rest_(bytes) {}

    template <class... T>
    void operator()(T&... values) {
        (get(values), ...);
    }
    void fail() { failed_ = true; }
    [[nodiscard]] bool failed() const { return failed_; }
    /// Whether all that was asked for was there, and nothing is left.
    [[nodiscard]] bool complete() const { return !failed_ && rest_.empty(); }

  private:
    template <class T>
    void get(T& value) {
        if (failed_) return;
        if constexpr (requires { value.keep(*this); }) {
            value.keep(*this);
        } else {
            static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
            get_bytes(&value, sizeof value);
        }
    }
    template <class T>
    void get(std::vector<T>& values) {
        const std::size_t count = get_size(std::is_trivially_copyable_v<T> ? sizeof(T) : 1);
        if (failed_) return;
        values.resize(count);
        if constexpr (std::is_trivially_copyable_v<T>) {
            get_bytes(values.data(), count * sizeof(T));
        } else {
            for (T& value : values) get(value);
        }
    }
    void get(std::string& text) {
        const std::size_t count = get_size(1);
        if (failed_) return;
        text.resize(count);
        get_bytes(text.data(), count);
    }
    template <class A, class B>
    void get(std::pair<A, B>& value) {
        get(value.first);
        get(value.second);
    }
    /// A number of elements that the rest has room for.
    std::size_t get_size(std::size_t element) {
        std::uint64_t count = 0;
        get_bytes(&count, sizeof count);
        if (count > rest_.size() / element) failed_ = true;
        return failed_ ? 0 : static_cast<std::size_t>(count);
    }
    void get_bytes(void* data, std::size_t size) {
        if (failed_ || size > rest_.size()) {
            failed_ = true;
            return;
        }
        if (size > 0) std::memcpy(data, rest_.data(), size);
        rest_.remove_prefix(size);
    }

    std::string_view rest_;
    bool failed_ = false;
};

}  // namespace talus
