#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/byte_planes.hpp"
#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/utf8.hpp"
#include "pack/cbor.hpp"

/// What structs hold, as CBOR and back. A struct names its members once, with TALUS_PACKED, for both directions; the
/// compiler refuses a list that lacks one of them.
namespace talus::pack {

/// Calls visit("a, b", value.a, value.b) with all members of an aggregate in their order.
#define TALUS_PACKED(Type, ...)                                \
    template <class Value_, class Visit_>                      \
    requires std::same_as<std::remove_const_t<Value_>, Type>   \
    void visit_members(Value_& value_, const Visit_& visit_) { \
        auto& [__VA_ARGS__] = value_;                          \
        visit_(#__VA_ARGS__, __VA_ARGS__);                     \
    }

/// The number of values of an enumeration, which go from 0.
template <class Enum>
inline constexpr std::uint64_t count_of = 0;

/// Cuts the first name off "a, b".
inline std::string_view next_name(std::string_view& names) {
    const std::size_t comma = names.find(',');
    const std::string_view name = names.substr(0, comma);
    names = comma == std::string_view::npos ? std::string_view() : names.substr(comma + 2);
    return name;
}

/// Numbers of which vectors are typed arrays. Indices have 32 bits, whatever a machine's pointers have.
template <class T>
inline constexpr std::optional<ArrayTag> tag_of = {};
template <>
inline constexpr std::optional<ArrayTag> tag_of<std::uint8_t> = ArrayTag::uint8;
template <>
inline constexpr std::optional<ArrayTag> tag_of<std::uint16_t> = ArrayTag::uint16;
template <>
inline constexpr std::optional<ArrayTag> tag_of<float> = ArrayTag::float32;
template <>
inline constexpr std::optional<ArrayTag> tag_of<double> = ArrayTag::float64;
template <>
inline constexpr std::optional<ArrayTag> tag_of<PlanPoint> = ArrayTag::float64;

class Writer {
  public:
    template <class T>
    void put(const T& value) {
        if constexpr (std::is_same_v<T, bool>) {
            out_.boolean(value);
        } else if constexpr (std::is_enum_v<T>) {
            static_assert(count_of<T> > 0);
            out_.whole(static_cast<std::uint64_t>(value));
        } else if constexpr (std::is_integral_v<T>) {
            if constexpr (std::is_signed_v<T>) {
                if (value < 0) return out_.negative(value);
            }
            out_.whole(static_cast<std::uint64_t>(value));
        } else if constexpr (std::is_floating_point_v<T>) {
            out_.number(static_cast<double>(value));
        } else {
            visit_members(value, [this](std::string_view names, const auto&... members) {
                out_.map(sizeof...(members));
                (put_member(names, members), ...);
            });
        }
    }
    /// Half a packed scene is terrain.
    template <std::same_as<Grid<float>> T>
    void put(const T& grid) {
        const std::string differences = to_difference_planes(grid);
        out_.map(2);
        out_.text("geometry");
        put(grid.geometry);
        out_.text("differences");
        out_.array(ArrayTag::uint8, differences.data(), differences.size());
    }
    void put(const std::string& value) { out_.text(value); }
    void put(const std::filesystem::path& value) { out_.text(value.generic_string()); }
    void put(const std::set<std::string>& values) { put(std::vector<std::string>(values.begin(), values.end())); }
    template <class T>
    void put(const std::optional<T>& value) {
        value ? put(*value) : out_.null();
    }
    template <class T>
    void put(const std::shared_ptr<const T>& value) {
        value ? put(*value) : out_.null();
    }
    template <class T>
    void put(const std::vector<T>& values) {
        if constexpr (tag_of<T>.has_value()) {
            out_.array(*tag_of<T>, values.data(), values.size() * sizeof(T));
        } else if constexpr (std::is_same_v<T, std::size_t>) {
            const std::vector<std::uint32_t> indices(values.begin(), values.end());
            out_.array(ArrayTag::uint32, indices.data(), indices.size() * sizeof(std::uint32_t));
        } else {
            out_.list(values.size());
            for (const T& value : values) put(value);
        }
    }
    [[nodiscard]] std::string take() { return out_.take(); }

  private:
    template <class T>
    void put_member(std::string_view& names, const T& value) {
        out_.text(next_name(names));
        put(value);
    }

    CborWriter out_;
};

class Reader {
  public:
    explicit Reader(std::string_view bytes) : in_(bytes) {}

    template <class T>
    void get(T& value) {
        if constexpr (std::is_same_v<T, bool>) {
            value = in_.boolean();
        } else if constexpr (std::is_enum_v<T>) {
            const std::uint64_t number = in_.whole();
            if (number >= count_of<T>) return fail();
            value = static_cast<T>(number);
        } else if constexpr (std::is_integral_v<T> && std::is_signed_v<T>) {
            const std::int64_t number = in_.integer();
            if (!std::in_range<T>(number)) return fail();
            value = static_cast<T>(number);
        } else if constexpr (std::is_integral_v<T>) {
            const std::uint64_t number = in_.whole();
            if (!std::in_range<T>(number)) return fail();
            value = static_cast<T>(number);
        } else if constexpr (std::is_floating_point_v<T>) {
            value = static_cast<T>(in_.number());
        } else {
            visit_members(value, [this](std::string_view names, auto&... members) {
                in_.map(sizeof...(members));
                (get_member(names, members), ...);
            });
        }
    }
    template <std::same_as<Grid<float>> T>
    void get(T& grid) {
        grid.values.clear();
        in_.map(2);
        std::string_view name = "geometry";
        get_member(name, grid.geometry);
        if (in_.text() != "differences") return fail();
        const std::string_view bytes = in_.array(ArrayTag::uint8, sizeof(std::uint8_t));
        if (failed() || grid.geometry.columns < 1 || bytes.size() % sizeof(float) != 0) return fail();
        grid.values = from_difference_planes(bytes, grid.geometry.columns);
    }
    void get(std::string& value) {
        value = in_.text();
        if (invalid_utf8(value) != std::string::npos) fail();
    }
    void get(std::filesystem::path& value) {
        std::string text;
        get(text);
        value = std::filesystem::path(text);
    }
    void get(std::set<std::string>& values) {
        std::vector<std::string> all;
        get(all);
        values = {all.begin(), all.end()};
    }
    template <class T>
    void get(std::optional<T>& value) {
        value.reset();
        if (!in_.null()) get(value.emplace());
    }
    template <class T>
    void get(std::shared_ptr<const T>& value) {
        value.reset();
        if (in_.null()) return;
        auto made = std::make_shared<T>();
        get(*made);
        value = std::move(made);
    }
    template <class T>
    void get(std::vector<T>& values) {
        values.clear();
        if constexpr (tag_of<T>.has_value()) {
            copy(in_.array(*tag_of<T>, sizeof(T)), values);
        } else if constexpr (std::is_same_v<T, std::size_t>) {
            std::vector<std::uint32_t> indices;
            copy(in_.array(ArrayTag::uint32, sizeof(std::uint32_t)), indices);
            values.assign(indices.begin(), indices.end());
        } else {
            const std::size_t count = in_.list();
            for (std::size_t i = 0; i < count && !in_.failed(); ++i) get(values.emplace_back());
        }
    }
    void fail() { in_.fail(); }
    [[nodiscard]] bool failed() const { return in_.failed(); }
    /// Whether all was there, and nothing is left.
    [[nodiscard]] bool complete() const { return in_.complete(); }

  private:
    template <class T>
    void get_member(std::string_view& names, T& value) {
        if (in_.text() != next_name(names)) fail();
        if (!failed()) get(value);
    }
    template <class T>
    static void copy(std::string_view bytes, std::vector<T>& values) {
        values.resize(bytes.size() / sizeof(T));
        if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    }

    CborReader in_;
};

}  // namespace talus::pack
