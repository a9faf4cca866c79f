#include "serve/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <openssl/evp.h>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr std::size_t longest_saved_name = 80, longest_note = 400;
constexpr std::string_view vector_type = "application/json";

std::string to_base64(const std::string& bytes) {
    std::vector<unsigned char> text(4 * ((bytes.size() + 2) / 3) + 1);
    const int size = EVP_EncodeBlock(text.data(), reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<int>(bytes.size()));
    return {text.begin(), text.begin() + size};
}

std::optional<std::string> from_base64(const std::string& text) {
    if (text.size() % 4 != 0 || text.size() > std::numeric_limits<int>::max()) return {};
    std::vector<unsigned char> bytes(text.size() / 4 * 3 + 1);
    const int size = EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(text.data()),
                                     static_cast<int>(text.size()));
    if (size < 0) return {};
    const auto padding =
        static_cast<int>(std::count(text.end() - std::min<std::ptrdiff_t>(2, std::ssize(text)), text.end(), '='));
    return std::string(bytes.begin(), bytes.begin() + size - padding);
}

bool is_picture(const std::string& type, std::string_view bytes) {
    if (type == "image/png") return bytes.starts_with("\x89PNG\r\n\x1a\n");
    return type == "image/webp" && bytes.size() > 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP";
}

std::string saved_text(const json& object, const char* key, std::size_t longest) {
    return tidy_name(text_at(object, key), longest);
}

double saved_number(const json& object, const char* key, double otherwise) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number() ? found->get<double>() : otherwise;
}

Result<Overlay> read_one(const json& written, const OverlayQuota& quota) {
    if (!written.is_object()) return Error{"must be an object"};
    TALUS_TRY(twin::check_keys(written, {"id", "name", "kind", "by", "visible", "opacity", "colour", "features",
                                         "outside", "styled", "low", "high", "note", "bytes", "type", "data"}));
    Overlay overlay;
    overlay.name = saved_text(written, "name", longest_saved_name);
    if (overlay.name.empty()) return Error{"name: missing; it must be a text"};
    overlay.by = saved_text(written, "by", longest_saved_name);
    overlay.note = saved_text(written, "note", longest_note);
    overlay.colour = geo::colour_of(saved_text(written, "colour", 7));
    if (overlay.colour.empty()) return Error{"colour: must be as #1f77b4"};
    overlay.visible = written.value("visible", json(true)) != false;
    overlay.opacity = std::clamp(saved_number(written, "opacity", 1), 0.0, 1.0);
    overlay.features = static_cast<std::size_t>(std::clamp(saved_number(written, "features", 0), 0.0, 1e9));
    overlay.outside = static_cast<std::size_t>(std::clamp(saved_number(written, "outside", 0), 0.0, 1e9));
    overlay.styled = written.value("styled", json(false)) == true;
    overlay.low = saved_number(written, "low", std::numeric_limits<double>::quiet_NaN());
    overlay.high = saved_number(written, "high", std::numeric_limits<double>::quiet_NaN());
    overlay.has_range = std::isfinite(overlay.low) && std::isfinite(overlay.high);
    overlay.type = saved_text(written, "type", longest_saved_name);
    const auto data = written.find("data");
    if (data == written.end() || !data->is_string()) return Error{"data: missing; it must be a text"};
    auto bytes = data->get<std::string>();
    overlay.picture = overlay.type != vector_type;
    if (overlay.picture) {
        auto decoded = from_base64(bytes);
        if (!decoded || !is_picture(overlay.type, *decoded)) return Error{"data: is no picture in Base64"};
        bytes = std::move(*decoded);
    } else if (const Status right = geo::check_overlay_text(bytes, quota.layer); !right) {
        return Error{"data: " + right.error().message};
    }
    overlay.data = std::make_shared<const std::string>(std::move(bytes));
    return Result<Overlay>(std::move(overlay));
}

}  // namespace

messages::Overlay message_of(const Overlay& overlay) {
    const auto range = [&](double value) { return overlay.has_range ? std::optional(value) : std::nullopt; };
    return {.id = overlay.id,
            .name = overlay.name,
            .kind = overlay.picture ? "picture" : "vector",
            .by = overlay.by,
            .visible = overlay.visible,
            .opacity = overlay.opacity,
            .colour = overlay.colour,
            .features = overlay.features,
            .outside = overlay.outside,
            .styled = overlay.styled,
            .low = range(overlay.low),
            .high = range(overlay.high),
            .note = overlay.note,
            .bytes = overlay.data->size()};
}

messages::SavedOverlay saved_of(const Overlay& overlay) {
    return {.overlay = message_of(overlay),
            .type = overlay.type,
            .data = overlay.picture ? to_base64(*overlay.data) : *overlay.data};
}

Result<std::vector<Overlay>> read_saved_overlays(const json& written, const OverlayQuota& quota) {
    std::vector<Overlay> overlays;
    if (written.is_null()) return overlays;
    if (!written.is_array() || written.size() > quota.count) {
        return Error{fmt::format("overlays: must be a list of up to {}", quota.count)};
    }
    std::size_t bytes = 0;
    for (std::size_t k = 0; k < written.size(); ++k) {
        auto overlay = read_one(written[k], quota);
        if (!overlay) return Error{fmt::format("overlays[{}]: {}", k, overlay.error().message)};
        bytes += overlay->data->size();
        overlays.push_back(std::move(*overlay));
    }
    if (bytes > quota.bytes) return Error{fmt::format("overlays: are longer than {} bytes", quota.bytes)};
    return Result<std::vector<Overlay>>(std::move(overlays));
}

}  // namespace talus::serve
