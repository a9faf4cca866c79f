#include "twin/recorded_flow.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "geo/longitude_latitude.hpp"
#include "products/debris_surface.hpp"
#include "products/series.hpp"
#include "run/run_scene.hpp"
#include "twin/results.hpp"
#include "twin/scenario_parts.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

std::size_t cells_of(const Frame& frame) {
    return std::size_t{frame.window[2]} * frame.window[3];
}

run::Frame as_of_run(const Frame& recorded, const GridGeometry& map, double thinnest_depth) {
    const auto [column, row, columns, rows] = recorded.window;
    const GridGeometry window{map.x_min + column * map.cell, map.y_min + row * map.cell, map.cell,
                              static_cast<int>(columns), static_cast<int>(rows)};
    run::Frame frame;
    frame.time = recorded.time;
    frame.thinnest_depth = thinnest_depth;
    frame.debris = {static_cast<int>(column), static_cast<int>(row), Grid<float>(window), Grid<float>(window),
                    Grid<float>(window)};
    const std::vector<DebrisAt> cells = debris_in_window(recorded);
    for (std::size_t k = 0; k < cells.size(); ++k) {
        frame.debris.depth.values[k] = static_cast<float>(cells[k].depth);
        frame.debris.speed.values[k] = static_cast<float>(cells[k].speed);
        frame.debris.density.values[k] = static_cast<float>(cells[k].density);
    }
    return frame;
}

std::string quoted(const std::string& name) {
    return json(name).dump(-1, ' ', true, json::error_handler_t::replace);
}

/// About how many bytes the formats take.
struct Sizes {
    double drawn = 0, maps = 0;
};

/// From a few of the frames. A point of the debris takes 28 bytes, its two triangles 24; around the debris there is a
/// rim of points without any.
Sizes sizes_of(const std::vector<FramePtr>& frames, const Grid<float>& peak_depth) {
    using products::DebrisSurface;
    constexpr std::size_t most_looked_at = 8;
    constexpr double thinnest_drawn = 0.01, rim = 1.25, of_debris = 52, of_ground = 48;
    constexpr double of_value = 3;  // compressed, in each of three maps
    double deep = 0, looked_at = 0;
    const std::size_t stride = std::max<std::size_t>(1, frames.size() / most_looked_at);
    for (std::size_t k = 0; k < frames.size(); k += stride, ++looked_at) {
        for (const DebrisAt& cell : debris_in_window(*frames[k])) deep += cell.depth >= thinnest_drawn ? 1 : 0;
    }
    deep /= std::max(1.0, looked_at);
    const auto count = static_cast<double>(frames.size());
    const double animated = std::min(count, static_cast<double>(DebrisSurface::max_frames));
    const double points = std::min(deep * rim * animated, static_cast<double>(DebrisSurface::max_debris_points));
    constexpr double around = 2.25;  // the margin around all that debris reached, on both sides
    const double ground = std::min(around * static_cast<double>(peak_depth.values.size()),
                                   static_cast<double>(DebrisSurface::max_ground_points));
    return {points * of_debris + ground * of_ground, 3 * of_value * deep * count};
}

}  // namespace

const std::vector<RecordedFlow::Format>& RecordedFlow::formats() {
    static const std::vector<Format> all = {
        {"gltf",
         "Ground, structures and an animation of the debris, for Blender, three.js and presentations",
         {"run.glb"}},
        {"3dtiles", "The same placed on the globe, for Cesium", {"tileset.json", "run.glb"}},
        {"geotiff",
         "Depth, speed and pressure with a band per frame, for QGIS and other GIS",
         {"depth.tif", "speed.tif", "pressure.tif"}},
        {"netcdf", "The same maps with time as a dimension, for Python, MATLAB and models", {"maps.nc"}}};
    return all;
}

RecordedFlow::RecordedFlow(scene::Scene scene, run::RunResult result, std::vector<FramePtr> frames,
                           const GridGeometry& map, double thinnest_depth, double recorded_interval)
    : scene_(std::move(scene)),
      result_(std::move(result)),
      frames_(std::move(frames)),
      map_(map),
      thinnest_depth_(thinnest_depth),
      recorded_interval_(recorded_interval) {}

/// Those that a run with this outputs.series_interval_s gives, of what is recorded.
std::vector<FramePtr> RecordedFlow::chosen(double interval) const {
    scene::Scene scene;
    scene.spec.outputs.series_interval = std::max(interval, recorded_interval_);
    run::RunOptions options;
    options.on_frame = [](const run::Frame&) {};
    run::FrameClock clock(scene, options);
    std::vector<FramePtr> chosen;
    std::copy_if(frames_.begin(), frames_.end(), std::back_inserter(chosen),
                 [&](const FramePtr& frame) { return clock.due(frame->time, frame == frames_.back()); });
    return chosen;
}

double RecordedFlow::kept_bytes(const std::vector<FramePtr>& frames) const {
    double cells = 0;
    for (const FramePtr& frame : frames) cells += static_cast<double>(cells_of(*frame));
    return cells * static_cast<double>(products::series_quantities.size() * sizeof(float));
}

std::string RecordedFlow::why_none(const Format& format, const std::vector<FramePtr>& frames) const {
    if (frames.size() < 2) return "nothing has moved yet: run the simulation first";
    if (format.name == "3dtiles" && !geo::to_wgs84(scene_.crs)) {
        return "the terrain's reference system is local, without a place on Earth";
    }
    if (const double bytes = kept_bytes(frames); bytes > most_bytes) {
        return fmt::format(
            "{} frames need {:.1f} GB of disk while they are written; at most {:.0f} GB: choose a "
            "longer interval",
            frames.size(), bytes / 1e9, most_bytes / 1e9);
    }
    return "";
}

messages::FlowOffer RecordedFlow::describe(double interval) const {
    const std::vector<FramePtr> frames = chosen(interval);
    const Sizes sizes = sizes_of(frames, result_.observation.maps.peak_depth);
    std::vector<messages::FlowFormatOffer> offered;
    offered.reserve(formats().size());
    for (const Format& format : formats()) {
        const bool drawn = format.name == "gltf" || format.name == "3dtiles";
        const std::size_t most = products::DebrisSurface::max_frames;
        offered.push_back({.name = std::string(format.name),
                           .what = std::string(format.what),
                           .files = {format.files.begin(), format.files.end()},
                           .frames = drawn ? std::min(frames.size(), most) : frames.size(),
                           .bytes = static_cast<std::int64_t>(drawn ? sizes.drawn : sizes.maps),
                           .refused = messages::if_any(why_none(format, frames))});
    }
    return {.scenario = {},
            .from_s = frames.front()->time,
            .to_s = frames.back()->time,
            .frames = frames.size(),
            .interval_s = std::max(interval, recorded_interval_),
            .shortest_interval_s = recorded_interval_,
            .formats = std::move(offered)};
}

Status RecordedFlow::check(const std::vector<std::string>& names, double interval) const {
    if (names.empty()) return Error{"formats = []; name at least one"};
    if (names.size() > formats().size()) {
        return Error{fmt::format("formats has {} names; there are {} formats", names.size(), formats().size())};
    }
    const std::vector<FramePtr> frames = chosen(interval);
    for (const std::string& name : names) {
        if (std::count(names.begin(), names.end(), name) > 1) {
            return Error{fmt::format("formats = {} is there twice", quoted(name))};
        }
        const auto format =
            std::find_if(formats().begin(), formats().end(), [&](const Format& one) { return one.name == name; });
        if (format == formats().end()) {
            std::vector<std::string_view> known;
            for (const Format& one : formats()) known.push_back(one.name);
            return Error{fmt::format("formats = {}; each is one of {}", quoted(name), fmt::join(known, ", "))};
        }
        if (const std::string why = why_none(*format, frames); !why.empty()) {
            return Error{fmt::format("there is no {}: {}", name, why)};
        }
    }
    return {};
}

Status RecordedFlow::write(const std::vector<std::string>& names, double interval, const std::filesystem::path& folder,
                           const std::function<bool(double)>& go_on) const {
    TALUS_TRY(check(names, interval));
    constexpr double share_of_reading = 0.1;
    scene::Scene scene = scene_;
    scene.spec.outputs.series = names;
    products::Series series(scene, folder);
    bool ended = false;
    const auto still = [&](double share) {
        ended = ended || !go_on(share);
        return !ended;
    };
    const std::vector<FramePtr> frames = chosen(interval);
    for (std::size_t k = 0; k < frames.size(); ++k) {
        TALUS_TRY(series.add(as_of_run(*frames[k], map_, thinnest_depth_)));
        const double done = static_cast<double>(k + 1) / static_cast<double>(frames.size());
        if (!still(share_of_reading * done)) return Error{"the export was cancelled"};
    }
    const std::vector<std::string> missing =
        series.finish(result_, [&](double share) { return still(share_of_reading + (1 - share_of_reading) * share); });
    if (ended) return Error{"the export was cancelled"};
    if (!missing.empty()) return Error{fmt::format("{}", fmt::join(missing, "; "))};
    return {};
}

std::shared_ptr<const RecordedFlow> recorded_flow_of(const Scenario& scenario) {
    const LiveRun& run = scenario.run();
    std::vector<FramePtr> frames = run.recording().frames();
    // Between two frames of the recording, or at its end.
    if (frames.empty() || frames.back()->time < run.summary().time) frames.push_back(run.frame(1, 0));
    auto [scene, result] = outcome_of(scenario);
    const observe::MapAccumulator& maps = run.observer().maps();
    return std::make_shared<const RecordedFlow>(std::move(scene), std::move(result), std::move(frames), maps.geometry(),
                                                maps.thinnest_depth(), scenario.parts().options.frame_interval);
}

}  // namespace talus::twin
