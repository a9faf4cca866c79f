#include "geo/spatial_reference.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <cpl_conv.h>
#include <fmt/format.h>

#include "core/lower_case.hpp"
#include "core/utf8.hpp"
#include "geo/gdal.hpp"
#include "geo/latitude.hpp"

namespace talus::geo {

namespace {

/// Code and name of the EPSG system that matches with certainty, for references that come without a code (.prj files).
bool identify(const OGRSpatialReference& reference, Crs& crs) {
    int count = 0;
    int* confidence = nullptr;
    OGRSpatialReferenceH* matches = reference.FindMatches(nullptr, &count, &confidence);
    bool found = false;
    if (count > 0 && confidence[0] >= 90 && (count == 1 || confidence[1] < confidence[0])) {
        const auto* match = OGRSpatialReference::FromHandle(matches[0]);
        const char* authority = match->GetAuthorityName(nullptr);
        const char* code = match->GetAuthorityCode(nullptr);
        if (authority != nullptr && code != nullptr && std::string(authority) == "EPSG") {
            crs.epsg = std::atoi(code);
            crs.name = match->GetName();
            found = true;
        }
    }
    OSRFreeSRSArray(matches);
    CPLFree(confidence);
    return found;
}

}  // namespace

std::string Crs::label() const {
    if (wkt.empty() && epsg == 0) return "no CRS";
    if (epsg == 0) return name.empty() ? "unnamed CRS" : name;
    return name.empty() ? fmt::format("EPSG:{}", epsg) : fmt::format("EPSG:{} ({})", epsg, name);
}

Crs Crs::own_metres() {
    OGRSpatialReference reference;
    reference.SetLocalCS("local coordinates");
    reference.SetLinearUnits("metre", 1);
    return to_crs(reference);
}

Result<Crs> crs_from_text(const std::string& text) {
    if (text == "local") return Crs::own_metres();
    const GdalMessages messages;
    const char* const options[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
    OGRSpatialReference reference;
    if (text.empty() || reference.SetFromUserInput(text.c_str(), options) != OGRERR_NONE) {
        return Error{
            fmt::format("crs = \"{}\" is not known; give a code such as \"EPSG:2326\", WKT, or "
                        "\"local\"",
                        text)};
    }
    return to_crs(reference);
}

Crs to_crs(const OGRSpatialReference& reference) {
    const GdalMessages messages;
    Crs crs;
    if (reference.IsEmpty()) return crs;
    OGRSpatialReference plan(reference);
    plan.StripVertical();
    const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
    char* wkt = nullptr;
    if (plan.exportToWkt(&wkt, options) == OGRERR_NONE) crs.wkt = to_utf8(wkt);
    CPLFree(wkt);
    crs.local = plan.IsLocal() != 0;
    if (const char* name = plan.GetName(); name != nullptr) crs.name = to_utf8(name);
    const char* authority = plan.GetAuthorityName(nullptr);
    const char* code = plan.GetAuthorityCode(nullptr);
    if (authority != nullptr && code != nullptr && std::string(authority) == "EPSG") {
        crs.epsg = std::atoi(code);
    } else if (!crs.local) {
        identify(plan, crs);
    }
    return crs;
}

OGRSpatialReference to_spatial_reference(const Crs& crs) {
    const GdalMessages messages;
    OGRSpatialReference reference;
    reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    if (!crs.wkt.empty()) {
        reference.importFromWkt(crs.wkt.c_str());
    } else if (crs.epsg != 0) {
        reference.importFromEPSG(crs.epsg);
    }
    return reference;
}

bool same_crs(const OGRSpatialReference& a, const OGRSpatialReference& b) {
    if (a.IsLocal() != 0 && b.IsLocal() != 0) return true;
    const GdalMessages messages;
    OGRSpatialReference plan_a(a), plan_b(b);
    plan_a.StripVertical();
    plan_b.StripVertical();
    const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                   "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
    if (plan_a.IsSame(&plan_b, options) != 0) return true;
    // A .prj file writes the same system with other names; the code that both match with certainty decides.
    const int code_a = to_crs(plan_a).epsg, code_b = to_crs(plan_b).epsg;
    return code_a != 0 && code_a == code_b;
}

bool is_undefined(const OGRSpatialReference* reference) {
    if (reference == nullptr || reference->IsEmpty() != 0) return true;
    const char* const name = reference->GetName();
    return name != nullptr && lower_case(name).starts_with("undefined");
}

std::optional<PlanPoint> to_longitude_latitude(const OGRSpatialReference& reference, const PlanPoint& p) {
    const GdalMessages messages;
    OGRSpatialReference from(reference);
    from.StripVertical();
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    PlanPoint q = p;
    if (from.IsGeographic() == 0) {
        // The system's own geographic base: no change of datum that could fail.
        const std::unique_ptr<OGRSpatialReference> base(from.CloneGeogCS());
        if (!base) return std::nullopt;
        base->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        const std::unique_ptr<OGRCoordinateTransformation> transformation(
            OGRCreateCoordinateTransformation(&from, base.get()));
        if (!transformation || transformation->Transform(1, &q.x, &q.y) == 0) return std::nullopt;
    }
    if (!(std::abs(q.y) <= 90) || !(std::abs(q.x) <= 540)) return std::nullopt;
    return q;
}

std::optional<double> latitude_deg(const Crs& crs, const PlanPoint& p) {
    if (crs.wkt.empty()) return std::nullopt;
    const auto place = to_longitude_latitude(to_spatial_reference(crs), p);
    if (!place) return std::nullopt;
    return place->y;
}

std::string metric_crs_for(const std::optional<PlanPoint>& place) {
    if (!place) return "EPSG:nnnn";
    if (place->y > 84) return "EPSG:5041";
    if (place->y < -80) return "EPSG:5042";
    const double turns = std::floor((place->x + 180) / 360);
    const int zone = std::clamp(static_cast<int>(std::floor((place->x - 360 * turns + 180) / 6)) + 1, 1, 60);
    return fmt::format("EPSG:{}", (place->y < 0 ? 32700 : 32600) + zone);
}

std::optional<double> scale_factor(const OGRSpatialReference& reference, const PlanPoint& p) {
    constexpr double reach = 500;  // m: far above rounding, far below the scale at which the factor changes
    constexpr double degree = std::numbers::pi / 180;
    const double a = reference.GetSemiMajor();
    const double inverse_flattening = reference.GetInvFlattening();
    const double flattening = inverse_flattening > 0 ? 1 / inverse_flattening : 0;
    const double e2 = flattening * (2 - flattening);
    double sum = 0;
    for (const PlanPoint& step : {PlanPoint{reach, 0}, PlanPoint{0, reach}}) {
        const auto from = to_longitude_latitude(reference, {p.x - step.x, p.y - step.y});
        const auto to = to_longitude_latitude(reference, {p.x + step.x, p.y + step.y});
        if (!from || !to) return std::nullopt;
        const double latitude = 0.5 * (from->y + to->y) * degree;
        const double w2 = 1 - e2 * std::sin(latitude) * std::sin(latitude);
        const double north = a * (1 - e2) / std::pow(w2, 1.5) * (to->y - from->y) * degree;
        const double east = a / std::sqrt(w2) * std::cos(latitude) * std::remainder(to->x - from->x, 360.0) * degree;
        const double distance = std::hypot(north, east);
        if (!(distance > 0)) return std::nullopt;
        sum += 2 * reach / distance;
    }
    return sum / 2;
}

}  // namespace talus::geo
