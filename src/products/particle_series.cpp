#include "products/particle_series.hpp"

#include <cstdint>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "products/vtk_file.hpp"

namespace talus::products {

namespace {

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
    for (std::size_t i = 0; i < count; ++i) speed[i] = length(state.velocity.at(i));
    VtkPolyData data(interleaved(state.position, count));
    data.on_points("velocity_mps", interleaved(state.velocity, count), 3)
        .on_points("speed_mps", speed)
        .on_points("id", first(state.id, count))
        .on_points("held", first(state.held, count));
    TALUS_TRY(data.write_points(folder_ / frame_name(times_.size()), frame.origin, state.time));
    times_.push_back(state.time);
    return {};
}

Status ParticleSeries::finish() {
    if (times_.empty()) return {};
    std::vector<VtkFrame> frames;
    for (std::size_t i = 0; i < times_.size(); ++i) frames.push_back({times_[i], frame_name(i)});
    return write_vtk_collection(folder_ / "particles.pvd", frames);
}

}  // namespace talus::products
