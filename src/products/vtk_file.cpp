#include "products/vtk_file.hpp"

#include <bit>
#include <type_traits>

#include <fmt/format.h>

#include "products/text_file.hpp"

namespace talus::products {
namespace {

static_assert(std::endian::native == std::endian::little, "the files declare little-endian data");

template <class T>
constexpr const char* type_name() {
    if (std::is_same_v<T, float>) return "Float32";
    if (std::is_same_v<T, double>) return "Float64";
    if (std::is_same_v<T, std::int64_t>) return "Int64";
    if (std::is_same_v<T, std::uint32_t>) return "UInt32";
    static_assert(std::is_same_v<T, float> || std::is_same_v<T, double> || std::is_same_v<T, std::int64_t> ||
                  std::is_same_v<T, std::uint32_t> || std::is_same_v<T, std::uint8_t>);
    return "UInt8";
}

}  // namespace

VtkPolyData::VtkPolyData(const std::vector<LocalPoint>& points) {
    coordinates_.reserve(3 * points.size());
    for (const LocalPoint& p : points) coordinates_.insert(coordinates_.end(), {p.x, p.y, p.z});
}

template <class T>
void VtkPolyData::add(std::string& elements, std::string_view name, const std::vector<T>& values, int components) {
    elements += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type_name<T>(), name, components, bytes_.size());
    const std::uint64_t size = values.size() * sizeof(T);
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof size);
    if (size > 0) bytes_.append(reinterpret_cast<const char*>(values.data()), size);
}

template void VtkPolyData::add(std::string&, std::string_view, const std::vector<float>&, int);
template void VtkPolyData::add(std::string&, std::string_view, const std::vector<double>&, int);
template void VtkPolyData::add(std::string&, std::string_view, const std::vector<std::uint32_t>&, int);
template void VtkPolyData::add(std::string&, std::string_view, const std::vector<std::uint8_t>&, int);

Status VtkPolyData::write_points(const std::filesystem::path& file, const WorldPoint& origin,
                                 std::optional<double> time) {
    const std::size_t count = coordinates_.size() / 3;
    std::vector<std::int64_t> connectivity(count), offsets(count);
    for (std::size_t i = 0; i < count; ++i) {
        connectivity[i] = static_cast<std::int64_t>(i);
        offsets[i] = static_cast<std::int64_t>(i) + 1;
    }
    std::string cells;
    add(cells, "connectivity", connectivity, 1);
    add(cells, "offsets", offsets, 1);
    return write(file, origin, time, fmt::format("NumberOfVerts=\"{}\" NumberOfPolys=\"0\"", count),
                 "<Verts>\n" + cells + "</Verts>\n");
}

Status VtkPolyData::write_triangles(const std::filesystem::path& file, const WorldPoint& origin,
                                    std::optional<double> time, const std::vector<std::uint32_t>& corners) {
    const std::vector<std::int64_t> connectivity(corners.begin(), corners.end());
    std::vector<std::int64_t> offsets(corners.size() / 3);
    for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = 3 * (static_cast<std::int64_t>(i) + 1);
    std::string cells;
    add(cells, "connectivity", connectivity, 1);
    add(cells, "offsets", offsets, 1);
    return write(file, origin, time, fmt::format("NumberOfVerts=\"0\" NumberOfPolys=\"{}\"", offsets.size()),
                 "<Polys>\n" + cells + "</Polys>\n");
}

Status VtkPolyData::write(const std::filesystem::path& file, const WorldPoint& origin, std::optional<double> time,
                          const std::string& counts, const std::string& cells) {
    std::string points;
    add(points, "position", coordinates_, 3);
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n";
    if (time) {
        text += fmt::format(
            "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{:.9g}</DataArray>\n",
            *time);
    }
    text += fmt::format(
        "<DataArray type=\"Float64\" Name=\"origin_m\" NumberOfComponents=\"3\" NumberOfTuples=\"1\" "
        "format=\"ascii\">{:.10g} {:.10g} {:.10g}</DataArray>\n</FieldData>\n",
        origin.x, origin.y, origin.z);
    text += fmt::format(
        "<Piece NumberOfPoints=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" {}>\n<Points>\n{}</Points>\n"
        "<PointData>\n{}</PointData>\n<CellData>\n{}</CellData>\n{}</Piece>\n</PolyData>\n"
        "<AppendedData encoding=\"raw\">\n_",
        coordinates_.size() / 3, counts, points, on_points_, on_cells_, cells);
    text += bytes_;
    text += "\n</AppendedData>\n</VTKFile>\n";
    return write_text_file(file, text);
}

Status write_vtk_collection(const std::filesystem::path& file, const std::vector<VtkFrame>& frames) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
        "<Collection>\n";
    for (const auto& [time, name] : frames) {
        text += fmt::format("<DataSet timestep=\"{:.9g}\" group=\"\" part=\"0\" file=\"{}\"/>\n", time, name);
    }
    return write_text_file(file, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace talus::products
