#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.hpp"

/// The notation of types in protocol.json. It is near TypeScript's: `number | null`, `Point[][]`, `[number, number]`,
/// `'held' | 'released'`, `Record<string, number>`, `Partial<Draft>`, `{ viewer: string; controller?: string }`, with
/// `integer` for a whole number and bounds in brackets: `integer(1..2000)`, and of a list's length `Point[](2..200)`.
/// Among alternatives `maps` stands for the keys of all maps of a run (core/hazard_maps.hpp).
namespace talus::serve {

struct Field;

struct Type {
    /// The first four are the plain values of JSON.
    enum class Kind {
        number,
        integer,
        string,
        boolean,
        null,
        object,
        text,
        whole,
        name,
        list,
        tuple,
        record,
        partial,
        fields,
        either
    };
    Kind kind = Kind::null;
    std::string name;         ///< of a name; what a text or a whole number is
    std::vector<Type> parts;  ///< items of a list; key and value of a record; alternatives
    std::vector<Field> fields;
    std::optional<std::pair<double, double>> bounds;  ///< of a number, or of the length of a list

    [[nodiscard]] bool may_be_null() const;
};

struct Field {
    std::string key;
    bool optional = false;
    Type type;
    std::string doc;  ///< a sentence; may be empty
};

/// `name`: of a name; what a text or a whole number is.
[[nodiscard]] Type of_kind(Type::Kind kind, std::string name = "");

/// Error: what was expected, and where.
[[nodiscard]] Result<Type> parse_type(std::string_view text);

/// `key` ends in ? where the field may be absent; `text` is its type, and behind " -- " a sentence.
[[nodiscard]] Result<Field> parse_field(std::string_view key, std::string_view text);

/// The two parts of a text at " -- ", the second of which may be absent.
[[nodiscard]] std::pair<std::string, std::string> split_doc(std::string_view text);

/// Adds the names of the types that it is made of.
void add_names(const Type& type, std::set<std::string>& names);

/// As TypeScript writes it.
[[nodiscard]] std::string typescript_of(const Type& type);

}  // namespace talus::serve
