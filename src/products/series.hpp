#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "products/debris_surface.hpp"
#include "products/particle_frames.hpp"
#include "products/particle_series.hpp"
#include "products/series_frames.hpp"
#include "run/run_result.hpp"
#include "run/run_scene.hpp"
#include "scene/scene.hpp"

namespace talus::products {

/// The run over time, in the formats that outputs.series names: takes the frames of a run and writes them when it has
/// ended, as files of `folder`.
class Series {
  public:
    /// `final_folder`: where the files will be in the end, if that is another.
    Series(const scene::Scene& scene, std::filesystem::path folder, std::filesystem::path final_folder = {});

    /// Whether the scene asks for any.
    [[nodiscard]] static bool wanted(const scene::Scene& scene) { return !scene.spec.outputs.series.empty(); }

    [[nodiscard]] Status add(const run::Frame& frame);
    /// Told how much of the writing is done, 0 to 1; false ends it.
    using Watch = std::function<bool(double share)>;
    /// On the cells of the result's maps. Returns why a format is missing, a sentence each; what was half-written of it
    /// is deleted, the others are there.
    [[nodiscard]] std::vector<std::string> finish(const run::RunResult& result, const Watch& watch = {});
    /// Of the frames, s; known once it has finished.
    [[nodiscard]] const std::vector<double>& times() const { return times_; }

  private:
    [[nodiscard]] bool wants(std::string_view format) const;
    void watch_rows(const Watch& watch);
    [[nodiscard]] double rows_of(const run::RunResult& result, const DebrisSurface* surface) const;
    [[nodiscard]] Status write_format(std::string_view format, const run::RunResult& result,
                                      const DebrisSurface* surface);
    [[nodiscard]] Status write_maps(const run::RunResult& result, bool netcdf) const;

    const scene::Scene& scene_;
    std::filesystem::path folder_, final_folder_;
    std::optional<SeriesFrames> frames_;
    std::vector<double> times_;
    std::size_t written_ = 0;        ///< formats, of those that the scene asks for
    double read_ = 0, to_read_ = 0;  ///< rows of frames, for the format that is written
    std::optional<ParticleSeries> particles_;
    std::optional<ParticleFrames> points_;
};

}  // namespace talus::products
