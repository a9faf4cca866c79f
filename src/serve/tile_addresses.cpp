#include "serve/tile_addresses.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "messages/messages.hpp"
#include "serve/message.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr std::size_t longest_address = 500, longest_by = 80, longest_port = 5;
/// What the page replaces by the number of a tile.
constexpr std::array<std::string_view, 6> tile_keys = {"{z}", "{x}", "{y}", "{TileMatrix}", "{TileCol}", "{TileRow}"};

/// "tile.example.org:8443": letters, digits, points and hyphens, then perhaps a port.
bool is_host(std::string_view host) {
    const std::size_t colon = host.find(':');
    const std::string_view name = host.substr(0, colon);
    const auto in_name = [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-'; };
    if (name.empty() || std::isalnum(static_cast<unsigned char>(name[0])) == 0 ||
        !std::all_of(name.begin(), name.end(), in_name)) {
        return false;
    }
    if (colon == std::string_view::npos) return true;
    const std::string_view port = host.substr(colon + 1);
    return !port.empty() && port.size() <= longest_port &&
           std::all_of(port.begin(), port.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The first {key} that the page would leave in the address; empty: there is none.
std::string unknown_key(const std::string& address) {
    for (std::size_t at = address.find('{'); at != std::string::npos; at = address.find('{', at + 1)) {
        const std::size_t end = address.find('}', at);
        std::string key = end == std::string::npos ? address.substr(at) : address.substr(at, end + 1 - at);
        if (std::find(tile_keys.begin(), tile_keys.end(), key) == tile_keys.end()) return key;
    }
    return "";
}

}  // namespace

std::string origin_of(const std::string& address) {
    const std::size_t host = address.find("://");
    return address.substr(0, address.find('/', host == std::string::npos ? 0 : host + 3));
}

std::string host_of(const std::string& address) {
    const std::string origin = origin_of(address);
    return origin.substr(origin.find("://") + 3);
}

std::string origins_of(const std::vector<std::string>& addresses) {
    std::string origins;
    for (const std::string& address : addresses) {
        const std::string origin = " " + origin_of(address);
        if ((origins + " ").find(origin + " ") == std::string::npos) origins += origin;
    }
    return origins;
}

Status check_tile_address(const std::string& address) {
    const auto refused = [&](const std::string& why) {
        return Error{fmt::format("{}: {}; for example https://tile.example.org/{{z}}/{{x}}/{{y}}.png",
                                 tidy_name(address, 100), why)};
    };
    if (!address.starts_with("https://") && !address.starts_with("http://"))
        return refused("begins with neither https:// nor http://");
    if (address.size() > longest_address) return refused(fmt::format("is longer than {} bytes", longest_address));
    const auto plain = [](unsigned char c) { return c > 0x20 && c < 0x7f && c != '"' && c != '\'' && c != '\\'; };
    if (!std::all_of(address.begin(), address.end(), plain)) return refused("has characters that no address has");
    const std::string origin = origin_of(address);
    const std::string host = host_of(address);
    if (const std::string key = unknown_key(host); !key.empty()) {
        return refused(fmt::format("has {} in the name of its host; write one of the names that it stands for", key));
    }
    if (!is_host(host)) return refused("names no host");
    const auto has = [&](std::initializer_list<const char*> keys) {
        return std::any_of(keys.begin(), keys.end(),
                           [&](const char* key) { return address.find(key, origin.size()) != std::string::npos; });
    };
    if (const std::string key = unknown_key(address); !key.empty()) {
        return refused(
            fmt::format("has {}; only {{z}}, {{x}} and {{y}}, or {{TileMatrix}}, {{TileCol}} and "
                        "{{TileRow}}, are replaced: write the value of any other",
                        tidy_name(key, 40)));
    }
    if (!has({"{z}", "{TileMatrix}"}) || !has({"{x}", "{TileCol}"}) || !has({"{y}", "{TileRow}"})) {
        return refused(
            "has no {z}, {x} and {y}, or {TileMatrix}, {TileCol} and {TileRow} of a WMTS, for the number of a tile");
    }
    return {};
}

Result<std::vector<TileAddress>> read_saved_tiles(const json& written) {
    std::vector<TileAddress> tiles;
    if (written.is_null()) return tiles;
    if (!written.is_array() || written.size() > most_tile_addresses) {
        return Error{fmt::format("tiles: must be a list of up to {}", most_tile_addresses)};
    }
    const auto read_one = [](const json& one) -> Result<TileAddress> {
        if (!one.is_object()) return Error{"must be an object"};
        TALUS_TRY(twin::check_keys(one, {"address", "by"}));
        TileAddress tile{"", text_at(one, "address"), tidy_name(text_at(one, "by"), longest_by)};
        if (tile.address.empty()) return Error{"address: missing; it must be a text"};
        if (const Status right = check_tile_address(tile.address); !right) {
            return Error{"address: " + right.error().message};
        }
        return Result<TileAddress>(std::move(tile));
    };
    for (std::size_t k = 0; k < written.size(); ++k) {
        auto tile = read_one(written[k]);
        if (!tile) return Error{fmt::format("tiles[{}]: {}", k, tile.error().message)};
        tiles.push_back(std::move(*tile));
    }
    return Result<std::vector<TileAddress>>(std::move(tiles));
}

TileAddresses::TileAddresses(const std::vector<std::string>& given) : given_(given.size()) {
    for (const std::string& address : given) list_.push_back({fmt::format("tiles-{}", ++numbers_), address, ""});
}

Result<TileAddress> TileAddresses::add(const std::string& address, const std::string& by) {
    TALUS_TRY(check_tile_address(address));
    if (std::any_of(list_.begin(), list_.end(), [&](const TileAddress& one) { return one.address == address; })) {
        return Error{fmt::format("{}: is there already", tidy_name(address, 100))};
    }
    if (list_.size() >= given_ + most_tile_addresses) {
        return Error{fmt::format("there are {} addresses of map tiles, the most there can be; remove one first",
                                 most_tile_addresses)};
    }
    list_.push_back({fmt::format("tiles-{}", ++numbers_), address, by.empty() ? "somebody" : by});
    return list_.back();
}

void TileAddresses::open(const std::vector<TileAddress>& saved) {
    // One that the program was started with is there already.
    for (const TileAddress& tile : saved) (void)add(tile.address, tile.by);
}

std::vector<TileAddress>::const_iterator TileAddresses::find(const std::string& id) const {
    return std::find_if(list_.begin(), list_.end(), [&](const TileAddress& one) { return one.id == id; });
}

bool TileAddresses::has(const std::string& id) const {
    return find(id) != list_.end();
}

Result<TileAddress> TileAddresses::remove(const std::string& id) {
    const auto found = find(id);
    if (found->by.empty()) return Error{"the program was started with this address; only its command line removes it"};
    TileAddress removed = *found;
    list_.erase(found);
    return Result<TileAddress>(std::move(removed));
}

std::vector<std::string> TileAddresses::addresses() const {
    std::vector<std::string> all;
    for (const TileAddress& tile : list_) all.push_back(tile.address);
    return all;
}

std::vector<messages::TileAddress> TileAddresses::describe() const {
    std::vector<messages::TileAddress> list;
    list.reserve(list_.size());
    for (const TileAddress& tile : list_) list.push_back({.id = tile.id, .address = tile.address, .by = tile.by});
    return list;
}

json TileAddresses::saved() const {
    json list = json::array();
    for (const TileAddress& tile : list_) {
        if (!tile.by.empty()) list.push_back(messages::SavedTiles{.address = tile.address, .by = tile.by});
    }
    return list;
}

}  // namespace talus::serve
