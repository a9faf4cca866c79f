#include "products/page_files.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "core/nodata.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"
#include "report/intensity.hpp"
#include "report/number_text.hpp"

namespace talus::products {
namespace {

/// The directory of a TIFF, and what its entries point to.
class Tiff {
  public:
    void shorts(std::uint16_t tag, const std::vector<std::uint16_t>& values) { add(tag, 3, values); }
    void longs(std::uint16_t tag, const std::vector<std::uint32_t>& values) { add(tag, 4, values); }
    void doubles(std::uint16_t tag, const std::vector<double>& values) { add(tag, 12, values); }
    void text(std::uint16_t tag, const std::string& text) {
        std::vector<char> bytes(text.begin(), text.end());
        bytes.push_back('\0');
        add(tag, 2, bytes);
    }
    /// The file: header, directory, values, and `strip`, to which the value of StripOffsets points.
    [[nodiscard]] std::string file(const std::string& strip) const {
        constexpr std::size_t header = 8, of_entry = 12;
        std::size_t at = header + 2 + of_entry * entries_.size() + 4;
        std::string directory, values;
        put(directory, static_cast<std::uint16_t>(entries_.size()));
        std::size_t sum = at;
        for (const Entry& entry : entries_) sum += entry.bytes.size() > 4 ? padded(entry.bytes.size()) : 0;
        for (const Entry& entry : entries_) {
            put(directory, entry.tag);
            put(directory, entry.type);
            put(directory, entry.count);
            std::string bytes = entry.bytes;
            if (entry.tag == strip_offsets) {
                bytes.clear();
                put(bytes, static_cast<std::uint32_t>(sum));
            }
            if (bytes.size() > 4) {
                put(directory, static_cast<std::uint32_t>(at + values.size()));
                bytes.resize(padded(bytes.size()));
                values += bytes;
            } else {
                bytes.resize(4);
                directory += bytes;
            }
        }
        put(directory, std::uint32_t{0});
        std::string all("II*\0\10\0\0\0", header);
        return all + directory + values + strip;
    }

    static constexpr std::uint16_t strip_offsets = 273;

  private:
    struct Entry {
        std::uint16_t tag, type;
        std::uint32_t count;
        std::string bytes;
    };
    /// Values begin at even places.
    static std::size_t padded(std::size_t size) { return size + size % 2; }
    template <class Number>
    static void put(std::string& to, Number number) {
        static_assert(std::endian::native == std::endian::little);
        char bytes[sizeof number];
        std::memcpy(bytes, &number, sizeof number);
        to.append(bytes, sizeof number);
    }
    template <class Number>
    void add(std::uint16_t tag, std::uint16_t type, const std::vector<Number>& values) {
        Entry entry{tag, type, static_cast<std::uint32_t>(values.size()), {}};
        for (const Number& value : values) put(entry.bytes, value);
        entries_.push_back(std::move(entry));
    }
    std::vector<Entry> entries_;  // in the order of their tags
};

/// What write_cog() writes of a band.
std::string metadata_of(const report::HazardMap& map, const scene::Scene& scene, const run::RunResult& result) {
    std::string xml = "<GDALMetadata>\n";
    const auto item = [&](const std::string& name, const std::string& value, const char* of) {
        // Twice, as GDAL does and undoes it.
        xml += fmt::format("  <Item name=\"{}\"{}>{}</Item>\n", name, of, report::escape(report::escape(value)));
    };
    for (const auto& [name, value] : origin_of(scene, result)) {
        if (name != "TIFFTAG_SOFTWARE") item(name, value, "");  // a tag of its own
    }
    item("DESCRIPTION", map.description + caveat(scene, result), " sample=\"0\" role=\"description\"");
    item("UNITTYPE", map.unit, " sample=\"0\" role=\"unittype\"");
    return xml + "</GDALMetadata>\n";
}

}  // namespace

std::string plain_geotiff(const Grid<float>& grid, int epsg, const std::string& metadata) {
    const GridGeometry& g = grid.geometry;
    const auto columns = static_cast<std::uint32_t>(g.columns), rows = static_cast<std::uint32_t>(g.rows);
    std::string strip;
    const std::size_t row_bytes = columns * sizeof(float);
    strip.reserve(row_bytes * rows);
    std::vector<float> line(columns);
    for (std::size_t row = rows; row-- > 0;) {  // from the north
        for (std::size_t column = 0; column < columns; ++column) {
            const float value = grid.values[row * columns + column];
            line[column] = std::isnan(value) ? nodata_in_files : value;
        }
        strip.append(reinterpret_cast<const char*>(line.data()), row_bytes);
    }
    Tiff tiff;
    tiff.longs(256, {columns});
    tiff.longs(257, {rows});
    tiff.shorts(258, {32});  // bits
    tiff.shorts(259, {1});   // not compressed
    tiff.shorts(262, {1});   // black is zero
    tiff.longs(Tiff::strip_offsets, {0});
    tiff.shorts(277, {1});
    tiff.longs(278, {rows});
    tiff.longs(279, {static_cast<std::uint32_t>(strip.size())});
    tiff.text(305, std::string("talus ") + TALUS_VERSION);
    tiff.shorts(339, {3});  // floating point
    tiff.doubles(33550, {g.cell, g.cell, 0});
    tiff.doubles(33922, {0, 0, 0, g.x_min, g.y_min + g.rows * g.cell, 0});
    const bool known = epsg > 0 && epsg < 32767;
    std::vector<std::uint16_t> keys{1, 1, 1, static_cast<std::uint16_t>(known ? 3 : 1)};
    if (known) keys.insert(keys.end(), {1024, 0, 1, 1});  // projected
    keys.insert(keys.end(), {1025, 0, 1, 1});             // a value is that of a cell
    if (known) keys.insert(keys.end(), {3072, 0, 1, static_cast<std::uint16_t>(epsg)});
    tiff.shorts(34735, keys);
    if (!metadata.empty()) tiff.text(42112, metadata);
    tiff.text(42113, fmt::format("{}", nodata_in_files));  // GDAL's tag
    return tiff.file(strip);
}

std::vector<PageFile> plain_maps_of(const scene::Scene& scene, const run::RunResult& result) {
    std::vector<PageFile> files;
    const auto add = [&](const report::HazardMap& map,
                         std::function<Grid<float>(const scene::Scene&, const observe::Observation&)> si) {
        files.push_back({map.file + ".tif", "image/tiff", map.unit.empty() ? map.title : map.title + ", " + map.unit,
                         [map, si = std::move(si)](const scene::Scene& of, const run::RunResult& run) {
                             return plain_geotiff(report::in_unit(si(of, run.observation), map.factor), of.crs.epsg,
                                                  metadata_of(map, of, run));
                         }});
    };
    for (const report::HazardMap& map : report::hazard_maps()) {
        add(map, [grid = map.grid](const scene::Scene&, const observe::Observation& o) { return o.maps.*grid; });
    }
    const report::IntensityGuideline& guideline = report::intensity_guideline(scene.spec.outputs.intensity_guideline);
    add(intensity_style(guideline),
        [&guideline](const scene::Scene&, const observe::Observation& o) { return intensity_map(guideline, o.maps); });
    if (scene.spec.outputs.peak_thickness) {
        add(report::thickness_map(), [](const scene::Scene& of, const observe::Observation& o) {
            return observe::normal_to_slope(o.maps.peak_depth, of.terrain);
        });
    }
    if (!result.observation.erosion.depth.values.empty()) {
        add(report::erosion_map(), [](const scene::Scene&, const observe::Observation& o) { return o.erosion.depth; });
    }
    return files;
}

}  // namespace talus::products
