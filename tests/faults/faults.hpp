#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <netinet/in.h>
#include <set>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cli/program.hpp"
#include "cli/small_scene.hpp"
#include "support/fixtures.hpp"

namespace talus::test {

/// A number from the environment, such as KILLS=200.
inline long wanted(const char* name, long otherwise) {
    const char* text = std::getenv(name);
    return text != nullptr ? std::atol(text) : otherwise;
}

/// A port of this machine that was free just now.
inline std::uint16_t free_port() {
    const int file = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    (void)::bind(file, reinterpret_cast<const sockaddr*>(&address), size);
    (void)::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
    ::close(file);
    return ntohs(address.sin_port);
}

/// Calls of the program under test that change files below a folder: counted, and one of them made to fail as on a full
/// disk. See failing_files.cpp.
class FailingFiles {
  public:
    /// Without a folder, large allocations of memory count instead.
    explicit FailingFiles(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

    /// Environment of a program whose call of this number, from 1, fails; 0: none.
    [[nodiscard]] std::vector<std::string> environment(long number) {
        std::filesystem::remove(log());
        return {std::string("LD_PRELOAD=") + FAILING_FILES, "FAILING_FOLDER=" + folder_.string(),
                "FAILING_CALL=" + std::to_string(number), "FAILING_LOG=" + log()};
    }
    /// "write /folder/file", the calls of the program that ran last.
    [[nodiscard]] std::vector<std::string> calls() const {
        EXPECT_TRUE(std::filesystem::exists(log())) << FAILING_FILES << " replaces no function of the C library";
        return lines_of(read_text(log()));
    }
    /// The one that failed; empty: none.
    [[nodiscard]] std::string failed() const {
        for (const std::string& call : calls()) {
            if (call.ends_with(" fails")) return call;
        }
        return "";
    }

  private:
    [[nodiscard]] std::string log() const { return outside_.file("calls"); }
    std::filesystem::path folder_;
    TemporaryFolder outside_;
};

/// Numbers of the calls that are to fail in turn: with EVERY_WRITE=1 all, otherwise some, of every kind of call and
/// file if there are no more.
inline std::vector<long> chosen(const std::vector<std::string>& calls, std::size_t some) {
    std::vector<long> numbers;
    std::set<std::string> kinds;
    for (std::size_t k = 0; k < calls.size(); ++k) {
        const std::string function = calls[k].substr(0, calls[k].find(' '));
        const std::string extension = std::filesystem::path(calls[k]).extension().string();
        const std::string kind = function == "allocate" ? calls[k] : function + extension;
        if (wanted("EVERY_WRITE", 0) != 0 || kinds.insert(kind).second) numbers.push_back(static_cast<long>(k) + 1);
    }
    if (wanted("EVERY_WRITE", 0) != 0 || numbers.size() <= some) return numbers;
    std::vector<long> spread;
    for (std::size_t k = 0; k < some; ++k) spread.push_back(numbers[k * (numbers.size() - 1) / (some - 1)]);
    return spread;
}

}  // namespace talus::test
