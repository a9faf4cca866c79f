#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "run/run_scene.hpp"

namespace talus::products {

/// A quantity of the maps over time.
struct SeriesQuantity {
    const char* name;         ///< of the variable and the file
    const char* description;  ///< of the band
    const char* unit;
};
inline constexpr std::array<SeriesQuantity, 3> series_quantities{
    {{"depth", "vertical flow depth", "m"},
     {"speed", "depth-averaged speed", "m/s"},
     {"pressure", "dynamic pressure, density times speed squared", "kPa"}}};

/// The maps of a run's frames, kept in a file until they are written in their formats: memory holds one row of them.
class SeriesFrames {
  public:
    explicit SeriesFrames(std::filesystem::path file) : file_(std::move(file)) {}
    /// Deletes the file.
    ~SeriesFrames();
    SeriesFrames(const SeriesFrames&) = delete;
    SeriesFrames& operator=(const SeriesFrames&) = delete;

    /// `rest_density`: kg/m3, where the frame has no other.
    [[nodiscard]] Status add(const run::Frame& frame, double rest_density);

    [[nodiscard]] const std::vector<double>& times() const { return times_; }  ///< s, rising
    /// Told of every row that is about to be read; its error is that of read().
    using Watch = std::function<Status()>;
    void watch(Watch watch) { watch_ = std::move(watch); }
    /// A row of a quantity on a grid of the frames' cells; NaN where there is no debris.
    [[nodiscard]] Status read(std::size_t quantity, std::size_t frame, const GridGeometry& grid, int row,
                              float* values) const;

  private:
    struct Window {
        GridGeometry geometry;
        long long offset = 0;  ///< of its quantities in the file, bytes
    };
    [[nodiscard]] Error failure(const char* what) const;

    std::filesystem::path file_;
    std::FILE* stream_ = nullptr;
    std::vector<double> times_;
    std::vector<Window> windows_;
    std::vector<float> values_;  ///< of the frame that is added
    long long size_ = 0;
    Watch watch_;
};

}  // namespace talus::products
