#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace talus {

/// What the kernel keeps this process from, by itself and for good.
struct Isolation {
    bool files = false;    ///< only folders that are named can be read, nothing can be written (Landlock, Linux 5.13)
    bool network = false;  ///< no connections, no other programs; only calls that readers of files need (seccomp)

    [[nodiscard]] bool complete() const { return files && network; }
};

/// What isolate() will achieve on this machine.
[[nodiscard]] Isolation available_isolation();

/// A sentence about what the kernel lacks; empty: nothing.
[[nodiscard]] std::string missing_isolation(const Isolation& isolation);

/// From now on this process, which has one thread, opens no file outside `readable`, files or folders, writes to none,
/// and has no network. Files that are open stay so. Returns what of it holds.
Isolation isolate(const std::vector<std::filesystem::path>& readable);

}  // namespace talus
