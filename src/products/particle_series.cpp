#include "products/particle_series.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "products/text_file.hpp"

namespace talus::products {

namespace {

static_assert(std::endian::native == std::endian::little, "the frames declare little-endian data");

/// The binary part of a VTK XML file: each array after a 64-bit count of its bytes.
class AppendedData {
  public:
    /// Adds an array and gives its DataArray element.
    template <class T>
    std::string add(const char* type, const char* name, int components, const std::vector<T>& values) {
        const std::size_t offset = bytes_.size();
        const std::uint64_t size = values.size() * sizeof(T);
        append(&size, sizeof size);
        append(values.data(), size);
        return fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)",
                           type, name, components, offset);
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

  private:
    void append(const void* data, std::size_t size) {
        if (size > 0) bytes_.append(static_cast<const char*>(data), size);
    }
    std::string bytes_;
};

std::vector<float> interleaved(const sim::VectorArray& array, std::size_t count) {
    std::vector<float> values(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        values[3 * i] = array.x[i];
        values[3 * i + 1] = array.y[i];
        values[3 * i + 2] = array.z[i];
    }
    return values;
}

template <class T>
std::vector<T> first(const std::vector<T>& all, std::size_t count) {
    return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::string frame_name(std::size_t number) {
    return fmt::format("particles_{:06}.vtp", number);
}

}  // namespace

ParticleSeries::ParticleSeries(std::filesystem::path folder) : folder_(std::move(folder)) {}

Status ParticleSeries::write_frame(const LocalFrame& frame, const sim::State& state) {
    std::error_code failed;
    std::filesystem::create_directories(folder_, failed);
    if (failed) return Error{fmt::format("{}: cannot be made: {}", folder_.string(), failed.message())};

    const std::size_t count = state.count;
    std::vector<float> speed(count);
    std::vector<std::int64_t> connectivity(count), offsets(count);
    for (std::size_t i = 0; i < count; ++i) {
        speed[i] = length(state.velocity.at(i));
        connectivity[i] = static_cast<std::int64_t>(i);
        offsets[i] = static_cast<std::int64_t>(i) + 1;
    }
    AppendedData data;
    const std::string points = data.add("Float32", "position", 3, interleaved(state.position, count));
    const std::string velocity = data.add("Float32", "velocity_mps", 3, interleaved(state.velocity, count));
    const std::string speeds = data.add("Float32", "speed_mps", 1, speed);
    const std::string ids = data.add("UInt32", "id", 1, first(state.id, count));
    const std::string held = data.add("UInt8", "held", 1, first(state.held, count));
    const std::string vertices = data.add("Int64", "connectivity", 1, connectivity);
    const std::string ends = data.add("Int64", "offsets", 1, offsets);
    const WorldPoint origin = frame.origin;

    std::string text = fmt::format(
        R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<FieldData>
<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{:.9g}</DataArray>
<DataArray type="Float64" Name="origin_m" NumberOfComponents="3" NumberOfTuples="1" format="ascii">{:.10g} {:.10g} {:.10g}</DataArray>
</FieldData>
<Piece NumberOfPoints="{}" NumberOfVerts="{}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
<Points>
{}
</Points>
<PointData Scalars="speed_mps" Vectors="velocity_mps">
{}
{}
{}
{}
</PointData>
<Verts>
{}
{}
</Verts>
</Piece>
</PolyData>
<AppendedData encoding="raw">
_)",
        state.time, origin.x, origin.y, origin.z, count, count, points, velocity, speeds, ids, held, vertices, ends);
    text += data.bytes();
    text += "\n</AppendedData>\n</VTKFile>\n";
    TALUS_TRY(write_text_file(folder_ / frame_name(times_.size()), text));
    times_.push_back(state.time);
    return {};
}

Status ParticleSeries::finish() {
    if (times_.empty()) return {};
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
        "<Collection>\n";
    for (std::size_t i = 0; i < times_.size(); ++i) {
        text +=
            fmt::format("<DataSet timestep=\"{:.9g}\" group=\"\" part=\"0\" file=\"{}\"/>\n", times_[i], frame_name(i));
    }
    text += "</Collection>\n</VTKFile>\n";
    return write_text_file(folder_ / "particles.pvd", text);
}

}  // namespace talus::products
