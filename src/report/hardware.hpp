#pragma once

#include <string>

namespace talus::report {

/// The machine that a run was made on, as reported by the system.
struct Hardware {
    std::string cpu;  ///< "" where the system does not say
    int logical_cores = 0;
    double memory_GiB = 0;  ///< 0 where the system does not say
    std::string system;     ///< "Linux 6.1.0 x86_64"
};

[[nodiscard]] Hardware this_machine();

/// "GCC 12.2.0", "Clang 17.0.6".
[[nodiscard]] std::string compiler_version();

}  // namespace talus::report
