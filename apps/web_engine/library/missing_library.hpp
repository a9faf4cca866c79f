#pragma once

/// What Debian's emscripten lacks of the standard library of C++20. Included before every file of the engine.

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <version>

#if !defined(__cpp_lib_atomic_ref)
namespace std {  // NOLINT(cert-dcl58-cpp): as the standard has it, for a page's one thread

template <class T>
class atomic_ref {
  public:
    explicit atomic_ref(T& value) : value_(&value) {}
    T load(memory_order = memory_order_seq_cst) const { return *value_; }
    void store(T wanted, memory_order = memory_order_seq_cst) const { *value_ = wanted; }
    T fetch_add(T more, memory_order = memory_order_seq_cst) const {
        const T before = *value_;
        *value_ = static_cast<T>(before + more);
        return before;
    }
    bool compare_exchange_strong(T& expected, T wanted, memory_order = memory_order_seq_cst,
                                 memory_order = memory_order_seq_cst) const {
        if (*value_ == expected) {
            *value_ = wanted;
            return true;
        }
        expected = *value_;
        return false;
    }

  private:
    T* value_;
};

}  // namespace std
#endif

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 20000
namespace std {  // NOLINT(cert-dcl58-cpp): of floating-point numbers; the C library rounds correctly

inline from_chars_result from_chars(const char* first, const char* last, double& value,
                                    chars_format format = chars_format::general) {
    const char* digits = first != last && *first == '-' ? first + 1 : first;
    const bool hexadecimal = last - digits > 1 && *digits == '0' && (digits[1] == 'x' || digits[1] == 'X');
    if (digits == last || !((*digits >= '0' && *digits <= '9') || *digits == '.' || *digits == 'i' || *digits == 'I' ||
                            *digits == 'n' || *digits == 'N')) {
        return {first, errc::invalid_argument};
    }
    const string text(first, hexadecimal ? digits + 1 : last);
    char* end = nullptr;
    errno = 0;
    const double read = strtod(text.c_str(), &end);
    const char* const stopped = first + (end - text.c_str());
    static_cast<void>(format);
    if (end == text.c_str()) return {first, errc::invalid_argument};
    if (errno == ERANGE && (read == HUGE_VAL || read == -HUGE_VAL || read == 0)) {
        return {stopped, errc::result_out_of_range};
    }
    value = read;
    return {stopped, errc()};
}

}  // namespace std
#endif
