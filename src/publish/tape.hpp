#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <nlohmann/json.hpp>

namespace talus::publish {

/// What a session has said and would answer, so that a page can show it without that session: the messages of its
/// WebSocket, and an answer for each address. docs/publish.md describes the bytes.
class Tape {
  public:
    /// A message, in the order in which a page gets them.
    void say(nlohmann::json message) { messages_.push_back(std::move(message)); }

    /// `address`: of a GET, without "api/" and the token: "scenarios/A/series". `type`: of its content.
    void add(const std::string& address, const std::string& type, std::string_view body);
    /// The same as of `time`, s, in the order of time: a page is given the last one at or before the time it asks for.
    /// One that equals the one before it takes no room.
    void add_at(const std::string& address, double time, const std::string& type, std::string_view body);

    /// Of all bodies, bytes, as they are kept.
    [[nodiscard]] std::size_t size() const { return bodies_.size(); }
    [[nodiscard]] std::string pack() const;

  private:
    [[nodiscard]] nlohmann::json keep(const std::string& type, std::string_view body);

    struct Last {
        std::string address, body;
    };
    nlohmann::json messages_ = nlohmann::json::array();
    nlohmann::json answers_ = nlohmann::json::object(), times_ = nlohmann::json::object();
    std::vector<Last> last_;                               // of each address with times
    std::unordered_map<std::size_t, std::size_t> places_;  // in bodies_, by the hash of a body
    std::string bodies_;
};

/// zlib's format.
[[nodiscard]] std::string deflated(std::string_view bytes);

}  // namespace talus::publish
