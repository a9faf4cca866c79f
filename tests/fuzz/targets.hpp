#pragma once

#include <span>
#include <string>

/// What reads bytes that others wrote. Bytes of any kind are accepted or refused with an error, and nothing else
/// happens: no crash, no exception, no endless work.
namespace talus::fuzz {

struct Target {
    const char* name;                       ///< also of its folder in corpus/
    bool (*run)(const std::string& bytes);  ///< whether it was accepted
};

[[nodiscard]] std::span<const Target> targets();

}  // namespace talus::fuzz
