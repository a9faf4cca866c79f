#pragma once

#include <memory>
#include <utility>

namespace talus {

/// A pointer to a value that is copied with it, so that whoever owns such values can be copied member by member.
template <class T>
class Copied {
  public:
    Copied() = default;
    Copied(std::unique_ptr<T> value) : value_(std::move(value)) {}  // NOLINT(google-explicit-constructor)
    Copied(const Copied& other) : value_(other.value_ ? std::make_unique<T>(*other.value_) : nullptr) {}
    Copied& operator=(const Copied& other) {
        if (this != &other) *this = Copied(other);
        return *this;
    }
    Copied(Copied&&) noexcept = default;
    Copied& operator=(Copied&&) noexcept = default;
    ~Copied() = default;

    [[nodiscard]] T& operator*() const { return *value_; }
    T* operator->() const { return value_.get(); }
    explicit operator bool() const { return value_ != nullptr; }
    [[nodiscard]] T* get() const { return value_.get(); }
    void reset() { value_.reset(); }

  private:
    std::unique_ptr<T> value_;
};

}  // namespace talus
