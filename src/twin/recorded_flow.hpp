#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "messages/messages.hpp"
#include "run/run_result.hpp"
#include "scene/scene.hpp"
#include "twin/frame.hpp"

namespace talus::twin {

class Scenario;

/// The moving flow of a run so far, from its recording: debris as it was seen, with every change of the setup. Written
/// by products::Series, in those of its formats that need no velocity of each particle. For any thread, while the run
/// continues.
class RecordedFlow {
  public:
    /// A format of outputs.series.
    struct Format {
        std::string_view name, what;
        std::vector<std::string_view> files;
    };
    [[nodiscard]] static const std::vector<Format>& formats();
    /// Of the maps of all frames that are kept in a file meanwhile; more is refused.
    static constexpr double most_bytes = 2e9;

    /// `frames`: at least one, in the order of time; `map`: the cells that they count; `recorded_interval`: between
    /// frames, s; `thinnest_depth`: m, thinner debris has no speed.
    RecordedFlow(scene::Scene scene, run::RunResult result, std::vector<FramePtr> frames, const GridGeometry& map,
                 double thinnest_depth, double recorded_interval);

    /// What there would be at an interval, s; the scenario's name is left empty. An interval that is shorter than the
    /// recording's gives all that is recorded.
    [[nodiscard]] messages::FlowOffer describe(double interval) const;
    [[nodiscard]] double default_interval() const { return scene_.spec.outputs.series_interval; }

    /// Whether these formats can be written at an interval. Errors: none or an unknown one, one that this run cannot
    /// have, too large.
    [[nodiscard]] Status check(const std::vector<std::string>& names, double interval) const;
    /// Writes them into an existing empty folder, as `talus run --series` does. `go_on`: told the share that is done, 0
    /// to 1; false ends the writing. Errors: as check(), ended, disk full; then files may be left.
    [[nodiscard]] Status write(const std::vector<std::string>& names, double interval,
                               const std::filesystem::path& folder, const std::function<bool(double)>& go_on) const;

  private:
    [[nodiscard]] std::vector<FramePtr> chosen(double interval) const;
    [[nodiscard]] std::string why_none(const Format& format, const std::vector<FramePtr>& frames) const;
    [[nodiscard]] double kept_bytes(const std::vector<FramePtr>& frames) const;

    scene::Scene scene_;
    run::RunResult result_;
    std::vector<FramePtr> frames_;
    GridGeometry map_;
    double thinnest_depth_, recorded_interval_;
};

/// Of the run so far. It copies the results.
[[nodiscard]] std::shared_ptr<const RecordedFlow> recorded_flow_of(const Scenario& scenario);

}  // namespace talus::twin
