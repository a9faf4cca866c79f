#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "commands.hpp"

namespace talus {

int fail(int code, const std::string& message) {
    std::string line = "talus: error: " + message;
    std::replace(line.begin(), line.end(), '\n', ' ');
    (void)std::fputs((line + "\n").c_str(), stderr);
    return code;
}

void set_data_folder(const std::string& folder) {
    setenv("TALUS_DATA", folder.c_str(), 1);
}

}  // namespace talus
