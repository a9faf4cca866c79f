#include "serve/overlays.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <fstream>
#include <functional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "serve/api.hpp"
#include "serve/draft.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double largest_picture = 1e9;  // pixels; it is read at a fraction of its size
constexpr std::size_t longest_layer_name = 80, most_files = 200;

/// Distinct on grass, rock and debris, for layers whose files have no style.
constexpr std::array<const char*, 8> layer_colours = {"#d1495b", "#1f6feb", "#e8a202", "#7b2d8b",
                                                      "#0b8457", "#c44900", "#00798c", "#5c4d3c"};

/// What the child or a reader says, by the name that the user gave the file, without folders.
std::string as_named(std::string message, const fs::path& folder, const std::string& kept, const std::string& name) {
    for (const std::string& path : {(folder / kept).string(), folder.string() + "/"}) {
        for (std::size_t at = 0; (at = message.find(path)) != std::string::npos;) message.erase(at, path.size());
    }
    while (!message.empty() && (message[0] == ':' || message[0] == ' ')) message.erase(0, 1);
    return message.starts_with(name + ":") ? message : name + ": " + message;
}

/// Never empty: a saved session must name its layers.
std::string layer_name(const std::string& given) {
    std::string name = tidy_name(given, longest_layer_name);
    return name.empty() ? "layer" : name;
}

Result<std::vector<Overlay>> read_overlay_file(const std::string& name, const fs::path& file, const fs::path& folder,
                                               const geo::ForeignReader& reader, const geo::OverlayGround& ground,
                                               const OverlayQuota& quota) {
    geo::ForeignWanted wanted;
    wanted.vector = wanted.picture = wanted.styles = true;
    wanted.cells = largest_picture;
    wanted.purpose =
        "is no layer of points, lines or areas and no picture; GeoPackage, GeoJSON, zipped Shapefile and "
        "GeoTIFF are";
    TALUS_ASSIGN(const geo::ForeignFile made, geo::convert_foreign(file, wanted, folder / "again", reader));
    std::vector<Overlay> overlays;
    const std::string stem = layer_name(fs::path(name).stem().string());
    if (made.kind == geo::FileKind::raster) {
        TALUS_ASSIGN(auto picture, geo::read_picture_overlay(made.file.string(), ground, quota.layer));
        Overlay overlay;
        overlay.name = stem;
        overlay.picture = overlay.styled = true;
        overlay.has_range = picture.has_range;
        overlay.low = picture.low;
        overlay.high = picture.high;
        overlay.note = picture.note;
        overlay.type = picture.type;
        overlay.data = std::make_shared<const std::string>(std::move(picture.bytes));
        overlays.push_back(std::move(overlay));
        return Result<std::vector<Overlay>>(std::move(overlays));
    }
    TALUS_ASSIGN(auto layers, geo::read_vector_overlays(made.file.string(), made.layers, ground, quota.layer,
                                                        {quota.count, quota.bytes}));
    for (geo::VectorOverlay& layer : layers) {
        Overlay overlay;
        overlay.name = layers.size() == 1 ? stem : layer_name(layer.name);
        overlay.features = layer.features;
        overlay.outside = layer.outside;
        overlay.styled = layer.styled;
        overlay.note = layer.note;
        overlay.type = "application/json";
        overlay.data = std::make_shared<const std::string>(std::move(layer.json));
        overlays.push_back(std::move(overlay));
    }
    return Result<std::vector<Overlay>>(std::move(overlays));
}

}  // namespace

/// A file on its way.
class Overlays::Taking : public Intake {
  public:
    Taking(Overlays& overlays, const Request& request) : overlays_(overlays) {
        serve::change(
            overlays.session_, request, [&](Response response) { refused_ = std::move(response); },
            [&](const std::string& by) { by_ = by; });
        if (const auto name = request.query.find("name"); name != request.query.end()) {
            name_ = tidy_name(name->second, 100);
        }
        if (!refused_ && name_.empty()) refused_ = error_response(400, "name: the file's name is missing");
        if (!refused_ && overlays.list_.size() >= overlays.quota_.count) {
            refused_ = error_response(409, fmt::format("there are {} layers, the most there can be; remove one first",
                                                       overlays.quota_.count));
        }
        folder_ = overlays.folder_ / fmt::format("{}", ++overlays.uploads_);
    }
    ~Taking() override {
        out_.close();
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    Taking(const Taking&) = delete;
    Taking& operator=(const Taking&) = delete;

    void take(std::string piece, std::function<void(std::optional<Response>)> then) override {
        if (refused_) return then(std::exchange(refused_, {}));
        // The connection holds this object until it is told.
        overlays_.lane_.post([this, piece = std::move(piece), then = std::move(then)] { then(write(piece)); });
    }
    void finish(const Respond& respond) override {
        if (refused_) return respond(std::move(*refused_));
        // The connection may let go of this object before the file is read.
        overlays_.lane_.post([&overlays = overlays_, name = name_, by = by_, respond,
                              folder = std::exchange(folder_, {}), closed = close_file()] {
            const auto read_all = [&]() -> Result<std::vector<Overlay>> {
                try {
                    TALUS_TRY(closed);
                    return overlays.read(name, folder);
                } catch (const std::exception& error) {  // running out of memory here must not end the live run
                    return Error{fmt::format("{}: cannot be read: {}", name, error.what())};
                }
            };
            auto read = read_all();
            std::error_code ignored;
            fs::remove_all(folder, ignored);
            if (!read) return respond(error_response(400, read.error().message));
            for (Overlay& overlay : *read) overlay.by = by;
            overlays.session_.post(
                [&overlays, respond, made = std::move(*read)]() mutable { overlays.add(std::move(made), respond); });
        });
    }

  private:
    Status close_file() {
        out_.close();
        return out_ ? Status() : Status(Error{name_ + ": cannot be kept; is the disk full?"});
    }
    std::optional<Response> write(const std::string& piece) {
        if (!out_.is_open()) {
            std::error_code error;
            fs::create_directories(folder_, error);
            out_.open(folder_ / "upload.part", std::ios::binary);
        }
        out_.write(piece.data(), static_cast<std::streamsize>(piece.size()));
        if (out_) return {};
        return error_response(507, name_ + ": cannot be kept; is the disk full?");
    }

    Overlays& overlays_;
    std::string name_, by_;
    std::optional<Response> refused_;
    fs::path folder_;
    std::ofstream out_;
};

Overlays::Overlays(Session& session, fs::path folder, geo::ForeignReader reader, const std::vector<std::string>& tiles,
                   OverlayQuota quota)
    : session_(session), folder_(std::move(folder)), reader_(std::move(reader)), quota_(quota), tiles_(tiles) {}

void Overlays::close() {
    *stop_ = true;
    lane_.close();
}

Result<std::vector<Overlay>> Overlays::read(const std::string& name, const fs::path& folder) const {
    const fs::path unpacked = folder / "foreign";
    geo::ForeignReader reader = reader_;
    reader.shall_end = [stop = stop_] { return stop->load(); };
    const scene::Scene& scene = *session_.scene();
    const geo::OverlayGround ground{scene.crs, scene.terrain.elevation().geometry.extent()};
    const auto failed = [&](const Error& error, const fs::path& file) {
        return Error{
            as_named(error.message, file.empty() ? unpacked : file.parent_path(), file.filename().string(), name)};
    };
    const auto file = unpack_upload(name, folder / "upload.part", unpacked, {quota_.upload, most_files});
    if (!file) return failed(file.error(), {});
    auto made = read_overlay_file(name, *file, folder, reader, ground, quota_);
    if (!made) return failed(Error{as_named(made.error().message, folder, "again", name)}, *file);
    return made;
}

void Overlays::give_id(Overlay& overlay) {
    if (overlay.colour.empty())
        overlay.colour = layer_colours[static_cast<std::size_t>(numbers_) % layer_colours.size()];
    overlay.id = fmt::format("overlay-{}", ++numbers_);
}

void Overlays::open(std::vector<Overlay> overlays, const std::vector<TileAddress>& tiles) {
    tiles_.open(tiles);
    list_ = std::move(overlays);
    for (Overlay& overlay : list_) give_id(overlay);
    tell();
}

void Overlays::tell() {
    session_.overlays(describe());
}

std::size_t Overlays::bytes() const {
    std::size_t sum = 0;
    for (const Overlay& overlay : list_) sum += overlay.data->size();
    return sum;
}

messages::Overlays Overlays::describe() const {
    messages::Overlays all{.overlays = {},
                           .removed = {},
                           .tiles = tiles_.describe(),
                           .bytes_left = quota_.bytes - std::min(quota_.bytes, bytes())};
    for (const Overlay& overlay : list_) all.overlays.push_back(message_of(overlay));
    if (const auto* overlay = std::get_if<Overlay>(&removed_)) all.removed = overlay->name;
    if (const auto* tile = std::get_if<TileAddress>(&removed_)) all.removed = host_of(tile->address);
    return all;
}

json Overlays::saved() const {
    json list = json::array();
    for (const Overlay& overlay : list_) list.push_back(saved_of(overlay));
    json all{{"overlays", std::move(list)}};
    // Programs from before there were any read a session without them.
    if (json tiles = tiles_.saved(); !tiles.empty()) all["tiles"] = std::move(tiles);
    return all;
}

std::shared_ptr<Intake> Overlays::intake(const Request& request) {
    return std::make_shared<Taking>(*this, request);
}

std::vector<Overlay>::iterator Overlays::find(const std::string& id) {
    return std::find_if(list_.begin(), list_.end(), [&](const Overlay& one) { return one.id == id; });
}

Status Overlays::has_room(const std::vector<Overlay>& more) const {
    std::size_t sum = bytes();
    for (const Overlay& overlay : more) sum += overlay.data->size();
    if (list_.size() + more.size() > quota_.count) {
        return Error{fmt::format("{} layers would be more than the {} that a session can have; remove some first",
                                 list_.size() + more.size(), quota_.count)};
    }
    if (sum > quota_.bytes) {
        return Error{fmt::format(
            "{}: the layers of a session can have {:.0f} MB together, with it they would have "
            "{:.1f} MB; remove some first",
            more.empty() ? "" : more[0].name, static_cast<double>(quota_.bytes) / 1e6, static_cast<double>(sum) / 1e6)};
    }
    return {};
}

void Overlays::add(std::vector<Overlay> overlays, const Respond& respond) {
    if (const Status room = has_room(overlays); !room) return respond(error_response(409, room.error().message));
    const std::size_t count = overlays.size();
    const std::string first = overlays[0].name;
    for (Overlay& overlay : overlays) {
        give_id(overlay);
        // Pictures cover the whole ground: they go below what is drawn on it.
        const auto at = overlay.picture
                            ? std::find_if(list_.begin(), list_.end(), [](const Overlay& one) { return !one.picture; })
                            : list_.end();
        list_.insert(at, std::move(overlay));
    }
    tell();
    respond(json_response(200, messages::Done{.done = count == 1 ? fmt::format("layer \"{}\" is added", first)
                                                                 : fmt::format("{} layers are added", count),
                                              .created = fmt::format("overlay-{}", numbers_)}));
}

void Overlays::data(const Request& request, bool picture, const Respond& respond) const {
    for (const Overlay& overlay : list_) {
        if (overlay.id != request.parameters.at("id") || overlay.picture != picture) continue;
        Response response;
        response.type = overlay.type;
        response.body = overlay.data;
        return respond(response);
    }
    respond(error_response(404, "there is no such layer; it may have been removed"));
}

void Overlays::change(const Request& request, const Respond& respond) {
    serve::change(session_, request, respond, [&](const std::string&) {
        const auto overlay = find(request.parameters.at("id"));
        if (overlay == list_.end())
            return respond(error_response(404, "there is no such layer; it may have been removed"));
        const Status changed = [&]() -> Status {
            TALUS_ASSIGN(const json wanted, read_object(request.body, {"name", "visible", "opacity", "colour"}));
            Overlay made = *overlay;
            TALUS_ASSIGN(const auto name, twin::read_text(wanted, "name", longest_layer_name));
            TALUS_ASSIGN(const auto opacity, twin::read_number(wanted, "opacity", {0, 1, true, true}, ""));
            TALUS_ASSIGN(const auto colour, twin::read_text(wanted, "colour", longest_layer_name));
            if (name) made.name = tidy_name(*name, longest_layer_name);
            if (name && made.name.empty()) {
                return Error{fmt::format("name = {}: must have characters that can be seen", twin::shown(*name))};
            }
            made.opacity = opacity.value_or(made.opacity);
            if (colour) made.colour = geo::colour_of(*colour);
            if (made.colour.empty()) return Error{fmt::format("colour = {}: must be as #1f77b4", *colour)};
            if (const auto visible = wanted.find("visible"); visible != wanted.end()) {
                if (!visible->is_boolean()) return Error{"visible: must be true or false"};
                made.visible = visible->get<bool>();
            }
            *overlay = std::move(made);
            return {};
        }();
        if (!changed) return respond(error_response(400, changed.error().message));
        tell();
        respond(json_response(
            200, messages::Done{.done = fmt::format("layer \"{}\" is changed", overlay->name), .created = {}}));
    });
}

void Overlays::remove(const Request& request, const Respond& respond) {
    serve::change(session_, request, respond, [&](const std::string&) {
        const auto overlay = find(request.parameters.at("id"));
        if (overlay == list_.end())
            return respond(error_response(404, "there is no such layer; it may have been removed"));
        const std::string name = overlay->name;
        removed_ = std::move(*overlay);
        list_.erase(overlay);
        tell();
        respond(
            json_response(200, messages::Done{.done = fmt::format("layer \"{}\" is removed", name), .created = {}}));
    });
}

void Overlays::restore(const Request& request, const Respond& respond) {
    serve::change(session_, request, respond, [&](const std::string&) {
        if (const auto* tile = std::get_if<TileAddress>(&removed_)) {
            return lay_tiles(TileAddress(*tile), respond);
        }
        const auto* overlay = std::get_if<Overlay>(&removed_);
        if (overlay == nullptr) return respond(error_response(409, "no layer has been removed"));
        if (const Status room = has_room({*overlay}); !room) return respond(error_response(409, room.error().message));
        std::vector<Overlay> again{*overlay};
        removed_ = {};
        add(std::move(again), respond);
    });
}

}  // namespace talus::serve
