#pragma once

#include <utility>

#include "core/result.hpp"

// Macros with which a function that returns a Result or a Status passes an Error on.

/// `TALUS_TRY(check(scene));` returns the Error, if there is one.
#define TALUS_TRY(...)                                    \
    do {                                                  \
        const auto& result_of_try = (__VA_ARGS__);        \
        if (!result_of_try) return result_of_try.error(); \
    } while (false)

/// `TALUS_ASSIGN(const Scene scene, load_scene(file));` declares a variable of the value, or returns the Error. An
/// existing variable can be assigned to as well.
#define TALUS_ASSIGN(target, ...) TALUS_ASSIGN_FROM(TALUS_JOIN(result_, __COUNTER__), target, __VA_ARGS__)
#define TALUS_ASSIGN_FROM(result, target, ...) \
    auto result = (__VA_ARGS__);               \
    if (!result) return result.error();        \
    target = std::move(result).value()
#define TALUS_JOIN(a, b) TALUS_JOIN_EXPANDED(a, b)
#define TALUS_JOIN_EXPANDED(a, b) a##b
