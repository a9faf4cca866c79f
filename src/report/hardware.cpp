#include "report/hardware.hpp"

#include <cstdlib>
#include <fstream>
#include <sys/utsname.h>
#include <thread>

namespace talus::report {

namespace {

/// The text after the colon of the first line that begins with `key`.
std::string entry(const char* file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.rfind(key, 0) != 0) continue;
        const auto colon = line.find(':');
        if (colon == std::string::npos) continue;
        const auto start = line.find_first_not_of(" \t", colon + 1);
        return start == std::string::npos ? "" : line.substr(start);
    }
    return "";
}

}  // namespace

Hardware this_machine() {
    Hardware machine;
    machine.cpu = entry("/proc/cpuinfo", "model name");
    machine.logical_cores = static_cast<int>(std::thread::hardware_concurrency());
    machine.memory_GiB = std::strtod(entry("/proc/meminfo", "MemTotal").c_str(), nullptr) / (1024.0 * 1024.0);
    utsname system{};
    if (uname(&system) == 0) {
        machine.system = std::string(system.sysname) + " " + system.release + " " + system.machine;
    }
    return machine;
}

std::string compiler_version() {
#if defined(__clang__)
    return std::string("Clang ") + __clang_version__;
#elif defined(__GNUC__)
    return std::string("GCC ") + __VERSION__;
#else
    return "";
#endif
}

}  // namespace talus::report
