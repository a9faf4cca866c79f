#pragma once

#include <cstddef>
#include <span>

namespace talus::sim::device {

/// Memory of the device for elements of one type. It grows as needed and never shrinks; growing loses the contents.
template <class T, class Executor>
class Array {
  public:
    explicit Array(Executor& executor) : executor_(executor) {}
    Array(const Array&) = delete;
    Array& operator=(const Array&) = delete;
    ~Array() { executor_.release(data_, size_ * sizeof(T)); }

    /// At least `size` elements.
    void reserve(std::size_t size) {
        if (size <= size_) return;
        executor_.release(data_, size_ * sizeof(T));
        data_ = nullptr;
        size_ = 0;
        data_ = static_cast<T*>(executor_.allocate(size * sizeof(T)));
        size_ = size;
    }
    void upload(std::span<const T> from) {
        reserve(from.size());
        executor_.upload(data_, from.data(), from.size_bytes());
    }
    void download(std::span<T> to) const { executor_.download(to.data(), data_, to.size_bytes()); }

    [[nodiscard]] T* data() const { return data_; }
    [[nodiscard]] std::size_t size() const { return size_; }

  private:
    Executor& executor_;
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace talus::sim::device
