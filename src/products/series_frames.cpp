#include "products/series_frames.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>

#include <fmt/format.h>

#include "core/try.hpp"

namespace talus::products {

SeriesFrames::~SeriesFrames() {
    if (stream_ == nullptr) return;
    std::fclose(stream_);
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
}

Error SeriesFrames::failure(const char* what) const {
    return Error{fmt::format("{}: cannot be {}: {}", file_.string(), what, std::strerror(errno))};
}

Status SeriesFrames::add(const run::Frame& frame, double rest_density) {
    if (stream_ == nullptr) stream_ = std::fopen(file_.c_str(), "w+b");
    if (stream_ == nullptr) return failure("made");
    const auto& [column, row, depth, speed, density] = frame.debris;
    const std::size_t cells = depth.values.size();
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    values_.assign(series_quantities.size() * cells, none);
    for (std::size_t cell = 0; cell < cells; ++cell) {
        if (!(depth.values[cell] > 0)) continue;
        values_[cell] = depth.values[cell];
        if (depth.values[cell] < frame.thinnest_depth) continue;
        const double fast = speed.values[cell];
        const double heavy = density.values.empty() ? rest_density : static_cast<double>(density.values[cell]);
        constexpr double kilo = 1e-3;
        values_[cells + cell] = speed.values[cell];
        values_[2 * cells + cell] = static_cast<float>(kilo * heavy * fast * fast);
    }
    if (std::fwrite(values_.data(), sizeof(float), values_.size(), stream_) != values_.size() ||
        std::fflush(stream_) != 0) {
        return failure("written");
    }
    times_.push_back(frame.time);
    windows_.push_back({depth.geometry, size_});
    size_ += static_cast<long long>(values_.size() * sizeof(float));
    return {};
}

Status SeriesFrames::read(std::size_t quantity, std::size_t frame, const GridGeometry& grid, int row,
                          float* values) const {
    if (watch_) TALUS_TRY(watch_());
    std::fill_n(values, grid.columns, std::numeric_limits<float>::quiet_NaN());
    const auto& [window, offset] = windows_[frame];
    if (window.size() == 0) return {};
    const auto cells = [&](double distance) { return static_cast<int>(std::lround(distance / grid.cell)); };
    const int in_window = row - cells(window.y_min - grid.y_min);
    const int shift = cells(window.x_min - grid.x_min);  // the window's first column on the grid
    const int first = std::max(0, shift), last = std::min(grid.columns, shift + window.columns);
    if (in_window < 0 || in_window >= window.rows || first >= last) return {};
    const std::size_t cell = quantity * window.size() + window.index(first - shift, in_window);
    const auto count = static_cast<std::size_t>(last - first);
    if (fseeko(stream_, offset + static_cast<long long>(cell * sizeof(float)), SEEK_SET) != 0 ||
        std::fread(values + first, sizeof(float), count, stream_) != count) {
        return failure("read");
    }
    return {};
}

}  // namespace talus::products
