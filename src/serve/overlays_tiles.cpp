// Map tiles of a session: their addresses, and where the terrain is on the globe.
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/longitude_latitude.hpp"
#include "messages/messages.hpp"
#include "serve/api.hpp"
#include "serve/overlays.hpp"
#include "session/json_text.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr int grid_steps = 32;  // of the terrain, between places whose longitude and latitude are told

Result<std::string> wanted_address(const std::string& body) {
    TALUS_ASSIGN(const json wanted, read_object(body, {"address"}));
    const auto address = wanted.find("address");
    if (address == wanted.end() || !address->is_string()) return Error{"address: missing; it must be a text"};
    TALUS_TRY(check_tile_address(address->get<std::string>()));
    return address->get<std::string>();
}

}  // namespace

void Overlays::tiles(const Respond& respond) const {
    const scene::Scene& scene = *session_.scene();
    messages::Tiles told{.addresses = tiles_.addresses(), .steps = grid_steps, .degrees = {}};
    if (!told.addresses.empty()) {
        const auto to_degrees = geo::to_wgs84(scene.crs);
        if (!to_degrees) return respond(error_response(409, to_degrees.error().message));
        const Extent extent = scene.terrain.elevation().geometry.extent();
        for (int j = 0; j <= grid_steps; ++j) {
            for (int i = 0; i <= grid_steps; ++i) {
                const PlanPoint at = (*to_degrees)(
                    {extent.x_min + i * extent.width() / grid_steps, extent.y_min + j * extent.height() / grid_steps});
                told.degrees.insert(told.degrees.end(), {at.x, at.y});
            }
        }
    }
    respond(json_response(200, told));
}

void Overlays::lay_tiles(const TileAddress& tile, const Respond& respond) {
    const auto added = tiles_.add(tile.address, tile.by);
    if (!added) return respond(error_response(409, added.error().message));
    const auto* removed = std::get_if<TileAddress>(&removed_);
    if (removed != nullptr && removed->address == tile.address) removed_ = {};  // it is back
    tell();
    respond(json_response(
        200, messages::Done{.done = fmt::format("the map of {} can be chosen as background", host_of(tile.address)),
                            .created = added->id}));
}

void Overlays::add_tiles(const Request& request, const Respond& respond) {
    serve::change(session_, request, respond, [&](const std::string& by) {
        const auto address = wanted_address(request.body);
        if (!address) return respond(error_response(400, address.error().message));
        lay_tiles({"", *address, by}, respond);
    });
}

void Overlays::remove_tiles(const Request& request, const Respond& respond) {
    serve::change(session_, request, respond, [&](const std::string&) {
        const std::string& id = request.parameters.at("id");
        if (!tiles_.has(id)) {
            return respond(error_response(404, "there is no such address of map tiles; it may have been removed"));
        }
        auto removed = tiles_.remove(id);
        if (!removed) return respond(error_response(409, removed.error().message));
        const std::string host = host_of(removed->address);
        removed_ = std::move(*removed);
        tell();
        respond(
            json_response(200, messages::Done{.done = fmt::format("the map of {} is removed", host), .created = {}}));
    });
}

}  // namespace talus::serve
