#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "support/witness.hpp"

namespace talus::test {

Witness::Witness(const std::string& log) : log_(log) {
    std::ofstream(log_, std::ios::trunc).flush();
    setenv("WITNESS_LOG", log_.c_str(), 1);
}

Witness::~Witness() {
    unsetenv("WITNESS_LOG");
}

std::vector<std::string> Witness::lines() const {
    std::vector<std::string> all;
    std::ifstream in(log_);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
}

std::vector<std::string> Witness::elsewhere(const std::vector<std::string>& folders) const {
    // Libraries and their tables, the system's own: nothing of a user.
    static const std::vector<std::string> installed = {
        "/usr/", "/lib/",     "/lib64/",      "/etc/ld.so",     "/proc/self/", "/proc/meminfo",       "/proc/cpuinfo",
        "/sys/", "/dev/null", "/dev/urandom", "/etc/localtime", "/etc/gss/",   "/etc/ssl/openssl.cnf"};
    std::vector<std::string> found;
    for (const std::string& line : lines()) {
        if (line.starts_with("process ")) continue;
        const std::string path = line.starts_with("open ") ? line.substr(5) : "";
        const auto below = [&](const std::string& folder) { return !folder.empty() && path.starts_with(folder); };
        if (!path.empty() && path.find("/../") == std::string::npos &&
            (std::any_of(folders.begin(), folders.end(), below) ||
             std::any_of(installed.begin(), installed.end(), below))) {
            continue;
        }
        found.push_back(line);
    }
    return found;
}

}  // namespace talus::test
