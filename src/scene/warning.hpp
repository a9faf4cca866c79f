#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Notes of a scene that change what its result means: they stand out on a terminal, in the summary and in the report.
namespace talus::scene {

inline constexpr std::string_view warning_mark = "WARNING: ";

/// The note as a warning.
[[nodiscard]] inline std::string as_warning(const std::string& note) {
    return std::string(warning_mark) + note;
}

/// The warning in a note, without its mark; nothing: it is an ordinary note.
[[nodiscard]] inline std::optional<std::string> warning_in(const std::string& note) {
    if (!note.starts_with(warning_mark)) return std::nullopt;
    return note.substr(warning_mark.size());
}

/// All of them, without their mark.
[[nodiscard]] inline std::vector<std::string> warnings_in(const std::vector<std::string>& notes) {
    std::vector<std::string> found;
    for (const std::string& note : notes) {
        if (auto warning = warning_in(note)) found.push_back(std::move(*warning));
    }
    return found;
}

}  // namespace talus::scene
