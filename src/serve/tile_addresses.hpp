#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "messages/messages.hpp"

namespace talus::serve {

/// Map tiles that browsers may load as a background; the server loads none itself.
struct TileAddress {
    std::string id;  ///< "tiles-1"; given by the session
    std::string address;
    std::string by;  ///< who added it; empty: the program was started with it
};

/// An address of map tiles, with {z}, {x} and {y}, or {TileMatrix}, {TileCol} and {TileRow} of a WMTS in Web Mercator.
/// Errors: not http or https, other characters in the host, a key that is missing or that no page replaces.
[[nodiscard]] Status check_tile_address(const std::string& address);
/// "https://tile.example.org", what a Content-Security-Policy names; `address` is one that has been checked.
[[nodiscard]] std::string origin_of(const std::string& address);
/// "tile.example.org", for people.
[[nodiscard]] std::string host_of(const std::string& address);
/// Of `addresses`, each once and with a space before it: the end of a list of a Content-Security-Policy.
[[nodiscard]] std::string origins_of(const std::vector<std::string>& addresses);

/// Addresses that people may add to those that the program was started with.
inline constexpr std::size_t most_tile_addresses = 8;

/// Of a saved session, which may come from anybody. Errors name the entry and what is wrong.
[[nodiscard]] Result<std::vector<TileAddress>> read_saved_tiles(const nlohmann::json& written);

/// Those of a session.
class TileAddresses {
  public:
    /// `given`: when the program was started; all pass check_tile_address.
    explicit TileAddresses(const std::vector<std::string>& given);

    /// Errors: check_tile_address, it is there already, too many.
    [[nodiscard]] Result<TileAddress> add(const std::string& address, const std::string& by);
    /// Of a saved session: those that are not there yet.
    void open(const std::vector<TileAddress>& saved);
    [[nodiscard]] bool has(const std::string& id) const;
    /// One that is there. Errors: the program was started with it.
    [[nodiscard]] Result<TileAddress> remove(const std::string& id);

    [[nodiscard]] std::vector<std::string> addresses() const;
    /// For the page.
    [[nodiscard]] std::vector<messages::TileAddress> describe() const;
    /// For a saved session: those that people added.
    [[nodiscard]] nlohmann::json saved() const;

  private:
    [[nodiscard]] std::vector<TileAddress>::const_iterator find(const std::string& id) const;

    std::vector<TileAddress> list_;
    std::size_t given_ = 0;  // the first so many
    int numbers_ = 0;
};

}  // namespace talus::serve
