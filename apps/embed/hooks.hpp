#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <new>
#include <string>
#include <type_traits>
#include <vector>

#include "talus.h"

/// What the program that uses the library has asked for with talus_set_log() and talus_set_allocator().
namespace talus::embed {

/// Tells the program's log, if it has one that wants this level.
void tell(int level, const std::string& sentence);

/// The program's allocator; without functions: that of C++.
struct Memory {
    void* (*allocate)(void* user, std::size_t bytes, std::size_t alignment) = nullptr;
    void (*release)(void* user, void* block, std::size_t bytes, std::size_t alignment) = nullptr;
    void* user = nullptr;
    bool operator==(const Memory&) const = default;
};
[[nodiscard]] Memory present_memory();

/// Gives back to the allocator that it took from, also when the program has set another one since.
template <class T>
class FromProgram {
  public:
    using value_type = T;
    using propagate_on_container_copy_assignment = std::true_type;
    using propagate_on_container_move_assignment = std::true_type;
    using propagate_on_container_swap = std::true_type;
    static constexpr std::size_t alignment = 64;  ///< of a cache line; a multiple of what any vector register wants

    FromProgram() : memory_(present_memory()) {}
    template <class U>
    FromProgram(const FromProgram<U>& other) : memory_(other.memory()) {}  // NOLINT(google-explicit-constructor)

    [[nodiscard]] T* allocate(std::size_t n) {
        if (n > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_array_new_length();
        const std::size_t bytes = n * sizeof(T);
        if (memory_.allocate == nullptr) return static_cast<T*>(::operator new (bytes, std::align_val_t{alignment}));
        void* const block = memory_.allocate(memory_.user, bytes, alignment);
        if (block == nullptr) throw std::bad_alloc();
        return static_cast<T*>(block);
    }
    void deallocate(T* block, std::size_t n) noexcept {
        if (memory_.release == nullptr) return ::operator delete (block, std::align_val_t{alignment});
        memory_.release(memory_.user, block, n * sizeof(T), alignment);
    }
    [[nodiscard]] const Memory& memory() const { return memory_; }
    template <class U>
    bool operator==(const FromProgram<U>& other) const {
        return memory_ == other.memory();
    }

  private:
    Memory memory_;
};

/// An array that the library hands out.
template <class T>
using Buffer = std::vector<T, FromProgram<T>>;

template <class T>
[[nodiscard]] Buffer<T> buffer_of(const std::vector<T>& values) {
    return Buffer<T>(values.begin(), values.end());
}

}  // namespace talus::embed
