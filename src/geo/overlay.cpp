#include "geo/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <ogr_geometry.h>
#include <ogrsf_frmts.h>

#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "core/visible_text.hpp"
#include "geo/clip.hpp"
#include "geo/gdal.hpp"
#include "geo/json_text.hpp"
#include "geo/spatial_reference.hpp"
#include "geo/vector.hpp"

namespace talus::geo {
namespace {

using nlohmann::json;

constexpr std::size_t most_attributes = 30, longest_key = 60, longest_shown = 200, most_feature_styles = 1000;
constexpr int deepest_collection = 8;

/// At most so many bytes, of whole characters, without what controls a terminal or turns the writing.
std::string shortened(const std::string& text, std::size_t longest) {
    if (text.size() <= longest) return visible(text);
    std::size_t end = longest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
    return visible(text.substr(0, end)) + "…";
}

/// From the layer's coordinates to the terrain's; none: they are the same.
struct Way {
    std::unique_ptr<OGRCoordinateTransformation> transformation;
    std::string note;
};

Result<Way> way_to(const OGRSpatialReference* stated, const Crs& crs) {
    Way way;
    const OGRSpatialReference to = to_spatial_reference(crs);
    if (is_undefined(stated)) {
        way.note = "states no coordinate reference system; taken to be in the terrain's";
        return Result<Way>(std::move(way));
    }
    OGRSpatialReference from(*stated);
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const Crs own = to_crs(from);
    if (crs.local || to.IsEmpty() != 0) {
        way.note = own.local ? "" : "taken to be in the terrain's local coordinates";
        return Result<Way>(std::move(way));
    }
    if (same_crs(from, to)) return Result<Way>(std::move(way));
    const GdalMessages quiet;
    OGRCoordinateTransformationOptions options;
    options.SetBallparkAllowed(false);
    way.transformation.reset(OGRCreateCoordinateTransformation(&from, &to, options));
    way.note = fmt::format("reprojected from {}", own.label());
    if (!way.transformation) {
        way.transformation.reset(OGRCreateCoordinateTransformation(&from, &to));
        way.note += " without a known change of datum: positions may be off by hundreds of metres";
    }
    if (!way.transformation) return Error{fmt::format("cannot be brought from {} to {}", own.label(), crs.label())};
    return Result<Way>(std::move(way));
}

/// The style of the file for one feature, if it has any; an attribute that says how to draw is none of its data.
class Styles {
  public:
    explicit Styles(const LayerSymbols& symbols) : symbols_(symbols) {}

    /// Takes what simplestyle-spec 1.1 names out of the attributes. -1: none.
    int take(std::map<std::string, Attribute>& attributes) {
        std::optional<FeatureStyle> style = by_symbols(attributes);
        bool own = false;
        FeatureStyle simple = style.value_or(FeatureStyle());
        const auto take_text = [&](const char* key) -> std::string {
            const auto node = attributes.extract(key);
            const auto* text = node ? std::get_if<std::string>(&node.mapped()) : nullptr;
            return text != nullptr ? *text : std::string();
        };
        const auto take_colour = [&](const char* key, std::string& to) {
            if (const std::string colour = colour_of(take_text(key)); !colour.empty()) {
                to = colour;
                own = true;
            }
        };
        const auto take_number = [&](const char* key, double& to) {
            const auto node = attributes.extract(key);
            if (const auto* number = node ? std::get_if<double>(&node.mapped()) : nullptr) to = *number;
        };
        take_colour("stroke", simple.stroke);
        take_colour("fill", simple.fill);
        take_colour("marker-color", simple.fill);
        take_number("stroke-width", simple.width_px);
        take_number("stroke-opacity", simple.stroke_opacity);
        if (attributes.contains("fill-opacity") || (own && !simple.fill.empty() && !style)) simple.fill_opacity = 0.6;
        take_number("fill-opacity", simple.fill_opacity);
        const std::string size = take_text("marker-size");
        simple.size_px = size == "small" ? 7 : size == "large" ? 15 : simple.size_px;
        take_text("marker-symbol");
        if (own) style = feature_style_of(to_json(simple));
        if (!style || style == FeatureStyle()) return -1;
        const auto same = std::find(list_.begin(), list_.end(), *style);
        if (same != list_.end()) return static_cast<int>(same - list_.begin());
        if (list_.size() >= most_feature_styles) return -1;
        list_.push_back(*style);
        return static_cast<int>(list_.size()) - 1;
    }
    [[nodiscard]] const std::vector<FeatureStyle>& list() const { return list_; }

  private:
    [[nodiscard]] std::optional<FeatureStyle> by_symbols(const std::map<std::string, Attribute>& attributes) const {
        std::string value;
        if (!symbols_.attribute.empty()) {
            const auto found = attributes.find(symbols_.attribute);
            if (found != attributes.end()) {
                if (const auto* text = std::get_if<std::string>(&found->second)) value = *text;
                if (const auto* number = std::get_if<double>(&found->second)) value = fmt::format("{}", *number);
            }
        }
        auto style = symbols_.values.find(value);
        if (style == symbols_.values.end()) style = symbols_.values.find("");
        return style == symbols_.values.end() ? std::nullopt : std::optional(style->second);
    }

    const LayerSymbols& symbols_;
    std::vector<FeatureStyle> list_;
};

/// Points, lines and areas of one feature, on the terrain.
struct Parts {
    std::vector<std::vector<PlanPoint>> points, lines, rings;
    [[nodiscard]] std::size_t count() const {
        std::size_t sum = 0;
        for (const auto* of : {&points, &lines, &rings}) {
            for (const auto& part : *of) sum += part.size();
        }
        return sum;
    }
};

std::vector<PlanPoint> curve_points(const OGRSimpleCurve& curve) {
    std::vector<PlanPoint> points;
    points.reserve(static_cast<std::size_t>(curve.getNumPoints()));
    for (int k = 0; k < curve.getNumPoints(); ++k) points.push_back({curve.getX(k), curve.getY(k)});
    return points;
}

void collect(const OGRGeometry& geometry, const Extent& extent, Parts& parts, int depth = 0) {
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    if (type == wkbPoint) {
        const OGRPoint& point = *geometry.toPoint();
        const PlanPoint at{point.getX(), point.getY()};
        if (extent.contains(at)) parts.points.push_back({at});
    } else if (type == wkbLineString) {
        for (auto& part : clip_line(curve_points(*geometry.toLineString()), extent)) {
            parts.lines.push_back(std::move(part));
        }
    } else if (type == wkbPolygon) {
        for (const OGRLinearRing* ring : *geometry.toPolygon()) {
            Ring outline = curve_points(*ring);
            if (outline.size() > 1 && outline.front() == outline.back()) outline.pop_back();
            if (Ring kept = clip_ring(outline, extent); !kept.empty()) parts.rings.push_back(std::move(kept));
        }
    } else if (type >= wkbMultiPoint && type <= wkbGeometryCollection && depth < deepest_collection) {
        for (const OGRGeometry* part : *geometry.toGeometryCollection()) collect(*part, extent, parts, depth + 1);
    }
}

json attributes_json(const std::map<std::string, Attribute>& attributes) {
    json list = json::object();
    for (const auto& [key, value] : attributes) {
        if (list.size() >= most_attributes) break;
        const std::string name = shortened(key, longest_key);
        if (const auto* number = std::get_if<double>(&value)) list[name] = *number;
        if (const auto* text = std::get_if<std::string>(&value); text != nullptr && !text->empty()) {
            list[name] = shortened(*text, longest_shown);
        }
    }
    return list;
}

class OverlayReader {
  public:
    OverlayReader(OGRLayer& layer, const LayerSymbols& symbols, const OverlayGround& ground,
                  const OverlayLimits& limits)
        : layer_(layer), ground_(ground), limits_(limits), styles_(symbols) {
        overlay_.name = shortened(layer.GetName(), longest_shown);
    }

    Result<VectorOverlay> read() {
        TALUS_ASSIGN(Way way, way_to(layer_.GetSpatialRef(), ground_.crs));
        overlay_.note = std::move(way.note);
        const GdalMessages quiet;
        layer_.ResetReading();
        while (true) {
            const OGRFeatureUniquePtr feature(layer_.GetNextFeature());
            if (!feature) break;
            OGRGeometry* geometry = feature->GetGeometryRef();
            if (geometry == nullptr || geometry->IsEmpty() != 0) continue;
            Parts parts;
            OGREnvelope around;
            const bool placed = !way.transformation || geometry->transform(way.transformation.get()) == OGRERR_NONE;
            geometry->getEnvelope(&around);
            if (placed && std::isfinite(around.MinX + around.MaxX + around.MinY + around.MaxY)) {
                collect(*geometry, ground_.extent, parts);
            }
            if (parts.count() == 0) {
                ++overlay_.outside;
                continue;
            }
            ++overlay_.features;
            points_ += parts.count();
            if (overlay_.features > limits_.features || points_ > limits_.points) {
                return Error{fmt::format(
                    "has more than {} features or {} points on the terrain; leave out or simplify what does not matter",
                    limits_.features, limits_.points)};
            }
            add(*feature, parts);
        }
        json styles = json::array();
        for (const FeatureStyle& style : styles_.list()) styles.push_back(to_json(style));
        overlay_.styled = !styles.empty();
        const json whole = {{"styles", std::move(styles)}, {"features", std::move(features_)}};
        overlay_.json = whole.dump(-1, ' ', false, json::error_handler_t::replace);
        if (overlay_.json.size() > limits_.bytes) {
            return Error{fmt::format("takes {:.1f} MB, at most {:.0f} MB can be; leave out attributes or features",
                                     static_cast<double>(overlay_.json.size()) / 1e6,
                                     static_cast<double>(limits_.bytes) / 1e6)};
        }
        return std::move(overlay_);
    }

  private:
    void add(const OGRFeature& feature, const Parts& parts) {
        std::map<std::string, Attribute> attributes;
        std::string name;
        for (int k = 0; k < feature.GetFieldCount(); ++k) {
            if (feature.IsFieldSetAndNotNull(k) == 0) continue;
            const OGRFieldDefn& field = *feature.GetFieldDefnRef(k);
            const std::string key = field.GetNameRef();
            if (field.GetType() == OFTString) {
                attributes[key] = std::string(feature.GetFieldAsString(k));
            } else if (const double number = feature.GetFieldAsDouble(k); std::isfinite(number)) {
                attributes[key] = number;
            }
        }
        const int style = styles_.take(attributes);
        for (auto it = attributes.begin(); it != attributes.end(); ++it) {
            const auto* text = std::get_if<std::string>(&it->second);
            if (text == nullptr || lower_case(it->first) != "name") continue;
            name = shortened(*text, longest_shown);
            attributes.erase(it);
            break;
        }
        const json told = attributes_json(attributes);
        const std::array<std::pair<const char*, const std::vector<std::vector<PlanPoint>>*>, 3> kinds{
            {{"area", &parts.rings}, {"line", &parts.lines}, {"point", &parts.points}}};
        for (const auto& [kind, list] : kinds) {
            if (list->empty()) continue;
            json written = json::array();
            for (const auto& part : *list) {
                json flat = json::array();
                for (const PlanPoint& p : part) {
                    flat.push_back(rounded(p.x - ground_.extent.x_min));
                    flat.push_back(rounded(p.y - ground_.extent.y_min));
                }
                written.push_back(std::move(flat));
            }
            features_.push_back({{"kind", kind},
                                 {"parts", std::move(written)},
                                 {"name", name},
                                 {"attributes", told},
                                 {"style", style}});
        }
    }
    /// To centimetres, finer in a laboratory.
    [[nodiscard]] double rounded(double length) const {
        const double steps = std::max(ground_.extent.width(), ground_.extent.height()) < 50 ? 1e4 : 1e2;
        return std::round(length * steps) / steps;
    }

    OGRLayer& layer_;
    const OverlayGround& ground_;
    const OverlayLimits& limits_;
    Styles styles_;
    VectorOverlay overlay_;
    json features_ = json::array();
    std::size_t points_ = 0;
};

bool can_be_seen(const json& value) {
    return !value.is_string() || visible(value.get_ref<const std::string&>()) == value.get_ref<const std::string&>();
}

Status check_feature(const json& feature, std::size_t styles, std::size_t& points) {
    if (!feature.is_object() || feature.size() != 5) return Error{"a feature has other keys"};
    const auto text = [&](const char* key) { return feature.contains(key) && feature[key].is_string(); };
    if (!text("kind") || !text("name")) return Error{"a feature has no kind or name"};
    const std::string kind = feature["kind"];
    if (kind != "point" && kind != "line" && kind != "area") return Error{"a feature is no point, line or area"};
    const json parts = feature.value("parts", json()), attributes = feature.value("attributes", json()),
               style = feature.value("style", json());
    // An unsigned number beyond 2^63 would equal -1.
    const bool none = style.is_number_integer() && !style.is_number_unsigned() && style == -1;
    if (!none && (!style.is_number_unsigned() || style.get<std::uint64_t>() >= styles)) {
        return Error{"a feature has no style"};
    }
    if (!attributes.is_object() || attributes.size() > most_attributes) return Error{"a feature has no attributes"};
    bool seen = can_be_seen(feature["name"]);
    for (const auto& [key, value] : attributes.items()) {
        if (!value.is_string() && !value.is_number()) return Error{"an attribute is no text and no number"};
        seen = seen && can_be_seen(key) && can_be_seen(value);
    }
    if (!seen) return Error{"a name or an attribute has characters that cannot be seen, or turn the writing"};
    if (!parts.is_array() || parts.empty()) return Error{"a feature has no parts"};
    for (const json& part : parts) {
        if (!part.is_array() || part.empty() || part.size() % 2 != 0) return Error{"a part is no list of places"};
        points += part.size() / 2;
        for (const json& number : part) {
            if (!number.is_number()) return Error{"a coordinate is no number"};
        }
    }
    return {};
}

}  // namespace

Result<std::vector<VectorOverlay>> read_vector_overlays(const std::string& file,
                                                        const std::vector<LayerSymbols>& symbols,
                                                        const OverlayGround& ground, const OverlayLimits& limits,
                                                        const OverlayFileLimits& together) {
    TALUS_ASSIGN(const auto data, open_dataset(file, GDAL_OF_VECTOR, "vector file"));
    std::vector<VectorOverlay> found;
    std::size_t outside = 0, bytes = 0;
    for (int k = 0; k < data->GetLayerCount(); ++k) {
        OGRLayer& layer = *data->GetLayer(k);
        const auto at = static_cast<std::size_t>(k);
        auto overlay = OverlayReader(layer, at < symbols.size() ? symbols[at] : LayerSymbols(), ground, limits).read();
        if (!overlay) return Error{fmt::format("layer \"{}\" {}", visible(layer.GetName()), overlay.error().message)};
        outside += overlay->outside;
        if (overlay->features == 0) continue;
        bytes += overlay->json.size();
        found.push_back(std::move(*overlay));
        if (found.size() > together.layers || bytes > together.bytes) {
            return Error{
                fmt::format("has more than {} layers, or more than {:.0f} MB of them, on the terrain; leave "
                            "some out",
                            together.layers, static_cast<double>(together.bytes) / 1e6)};
        }
    }
    if (!found.empty()) return Result<std::vector<VectorOverlay>>(std::move(found));
    if (outside == 0) return Error{"has no features"};
    return Error{fmt::format("lies outside the terrain: none of its {} features is on it", outside)};
}

Status check_overlay_text(const std::string& text, const OverlayLimits& limits) {
    if (text.size() > limits.bytes) return Error{fmt::format("is longer than {} bytes", limits.bytes)};
    TALUS_ASSIGN(const json whole, parse_json(text));
    const json styles = whole.is_object() ? whole.value("styles", json()) : json();
    const json features = whole.is_object() ? whole.value("features", json()) : json();
    if (!styles.is_array() || !features.is_array() || whole.size() != 2 || styles.size() > most_feature_styles ||
        features.empty() || features.size() > 3 * limits.features) {
        return Error{"is no list of features with styles"};
    }
    for (const json& style : styles) {
        if (to_json(feature_style_of(style)) != style) return Error{"a style is not one"};
    }
    std::size_t points = 0;
    for (const json& feature : features) TALUS_TRY(check_feature(feature, styles.size(), points));
    if (points > limits.points) return Error{fmt::format("has more than {} points", limits.points)};
    return {};
}

}  // namespace talus::geo
