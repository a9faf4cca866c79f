#include "session/secret.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <sys/random.h>

#include <fmt/format.h>

namespace talus::session {

bool same_secret(std::string_view given, std::string_view secret) {
    unsigned difference = given.size() == secret.size() ? 0 : 1;
    for (std::size_t i = 0; i < secret.size(); ++i) {
        const char c = i < given.size() ? given[i] : '\0';
        difference |= static_cast<unsigned char>(c) ^ static_cast<unsigned char>(secret[i]);
    }
    return difference == 0 && !secret.empty();
}

Result<std::string> random_token() {
    std::array<unsigned char, 16> bytes{};
    std::size_t filled = 0;
    while (filled < bytes.size()) {
        const ssize_t got = getrandom(bytes.data() + filled, bytes.size() - filled, 0);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return Error{fmt::format("the system gives no random numbers for tokens: {}", strerror(errno))};
        filled += static_cast<std::size_t>(got);
    }
    std::string text;
    for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
    return text;
}

}  // namespace talus::session
