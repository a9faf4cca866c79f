#pragma once

#include <cassert>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace talus {

/// What is wrong with an input, in one line: the file, the line, the key, the value and the allowed range, where they
/// apply.
struct Error {
    std::string message;
};

/// A value, or the Error that prevented it; Result<void> has no value, only success. Bad input travels in these; bugs
/// are assertions. TALUS_TRY and TALUS_ASSIGN (try.hpp) pass an Error on.
template <class T>
class [[nodiscard]] Result {
    using Value = std::conditional_t<std::is_void_v<T>, std::monostate, T>;

  public:
    Result() requires std::is_void_v<T>
    = default;
    Result(Value value) : content_(std::move(value)) {}
    Result(Error error) : content_(std::move(error)) {}

    [[nodiscard]] bool ok() const { return std::holds_alternative<Value>(content_); }
    explicit operator bool() const { return ok(); }

    [[nodiscard]] Value& value() & {
        assert(ok());
        return std::get<Value>(content_);
    }
    [[nodiscard]] const Value& value() const& {
        assert(ok());
        return std::get<Value>(content_);
    }
    [[nodiscard]] Value&& value() && {
        assert(ok());
        return std::get<Value>(std::move(content_));
    }
    Value& operator*() & { return value(); }
    const Value& operator*() const& { return value(); }
    Value&& operator*() && { return std::move(*this).value(); }
    Value* operator->() { return &value(); }
    const Value* operator->() const { return &value(); }

    [[nodiscard]] const Error& error() const {
        assert(!ok());
        return std::get<Error>(content_);
    }

  private:
    std::variant<Value, Error> content_;
};

/// Success, or the Error.
using Status = Result<void>;

}  // namespace talus
