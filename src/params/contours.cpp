#include "params/contours.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"

namespace talus::params {
namespace {

constexpr std::size_t most_values = 100;  // of a map

void sort_out(std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

Result<MapContours> contours_of(std::string_view text) {
    const std::size_t equals = text.find('=');
    MapContours contours{std::string(text.substr(0, equals)), {}};
    if (std::find(contour_maps.begin(), contour_maps.end(), contours.map) == contour_maps.end()) {
        return Error{fmt::format("\"{}\" is no map with contours; the maps are {}", contours.map,
                                 fmt::join(contour_maps, ", "))};
    }
    std::string_view rest = equals == std::string_view::npos ? std::string_view() : text.substr(equals + 1);
    while (true) {
        const std::size_t comma = rest.find(',');
        const std::string_view one = rest.substr(0, comma);
        double value = 0;
        const auto [end, failed] = std::from_chars(one.data(), one.data() + one.size(), value);
        const bool number = failed == std::errc() && end == one.data() + one.size();
        if (!number || !std::isfinite(value) || !(value > 0)) {
            return Error{fmt::format("\"{}\" is no value of a contour; give {}=VALUE,VALUE, numbers above 0", one,
                                     contours.map)};
        }
        contours.values.push_back(value);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    sort_out(contours.values);
    if (contours.values.size() > most_values) {
        return Error{fmt::format("{} contours of {} are too many; at most {} are drawn", contours.values.size(),
                                 contours.map, most_values)};
    }
    return contours;
}

Result<std::vector<MapContours>> contours_of(const std::vector<std::string>& texts) {
    std::vector<MapContours> all;
    for (const std::string& text : texts) {
        TALUS_ASSIGN(MapContours one, contours_of(std::string_view(text)));
        const auto same = std::find_if(all.begin(), all.end(), [&](const MapContours& c) { return c.map == one.map; });
        if (same == all.end()) {
            all.push_back(std::move(one));
            continue;
        }
        std::copy(one.values.begin(), one.values.end(), std::back_inserter(same->values));
        sort_out(same->values);
    }
    return all;
}

}  // namespace talus::params
