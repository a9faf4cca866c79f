#include "serve/publisher.hpp"

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "geo/latitude.hpp"
#include "pack/pack.hpp"
#include "publish/engine.hpp"
#include "serve/executor.hpp"
#include "serve/library.hpp"
#include "serve/server.hpp"
#include "session/json_text.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

/// An open session without a server: a lane stands for the server's.
class Hall {
  public:
    [[nodiscard]] Status open(ToPublish& wanted) {
        ServerOptions options;
        options.export_folder = wanted.folder;
        options.scenario.overrides = wanted.overrides;
        options.tokens = {"-", "-"};
        TALUS_ASSIGN(session_, OpenSession::open(thread_, executor_, wanted.scene, options, std::move(wanted.scenarios),
                                                 std::move(wanted.overlays)));
        return {};
    }
    ~Hall() {
        if (!session_) return;
        OpenSession::retire(thread_, std::move(session_));
        // The lane lets the session go two tasks later.
        std::promise<void> gone;
        lane_.post([&] { lane_.post([&] { lane_.post([&] { gone.set_value(); }); }); });
        gone.get_future().wait();
    }
    Hall() = default;
    Hall(const Hall&) = delete;
    Hall& operator=(const Hall&) = delete;
    [[nodiscard]] OpenSession& session() { return *session_; }

  private:
    Executor executor_;
    Lane lane_{executor_, "publisher"};
    Thread thread_{[this](std::function<void()> task) { lane_.post(std::move(task)); },
                   [](std::chrono::milliseconds) {}};  // nobody waits for lists of people
    OpenSessionPtr session_;
};

/// Its file's name: a path tells more than a reader should know.
std::string file_name(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

std::vector<std::string> contents_of(const scene::Scene& scene, const std::vector<RecordedRun>& runs) {
    std::vector<std::string> lines;
    lines.reserve(runs.size() + 8);
    for (const RecordedRun& run : runs) {
        lines.push_back(fmt::format("run {}: to {:.1f} s, {} frames", run.name, run.end, run.frames));
    }
    const GridGeometry& ground = scene.terrain.elevation().geometry;
    lines.push_back(fmt::format(
        "terrain: {} x {} cells of {:.3g} m, {}", ground.columns, ground.rows, ground.cell,
        scene.spec.scene.reconstruction ? "a reconstruction" : "as in " + file_name(scene.spec.terrain.file)));
    const std::string& photo = scene.spec.terrain.orthophoto;
    lines.push_back("orthophoto: " + (photo.empty() ? "none" : file_name(photo)));
    const std::vector<std::string>& sources = scene.spec.scene.sources;
    lines.push_back(sources.empty() ? "data of: the scene names no sources; check that you may pass its data on"
                                    : fmt::format("data of: {}", fmt::join(sources, "; ")));
    return lines;
}

/// The orthophoto is on the tape. Errors: a scene too large for a page.
Status add_engine(publish::Content& content, const scene::Scene& scene, const std::vector<std::string>& overrides) {
    const Extent e = scene.terrain.elevation().geometry.extent();
    pack::Packed packed{
        .scene = scene,
        .overrides = overrides,
        .latitude = geo::latitude_deg(scene.crs, {0.5 * (e.x_min + e.x_max), 0.5 * (e.y_min + e.y_max)})};
    leave_out_zoom(packed.scene, "a published twin");
    if (const Status fits = pack::check_size(packed); !fits) {
        return Error{fmt::format("{}; or publish the recorded run alone with --without-engine", fits.error().message)};
    }
    content.scene = pack::write(packed);
    content.engine = publish::find_engine();
    return {};
}

}  // namespace

bool carries_engine() {
    return publish::find_engine().has_value();
}

Status check_twin_size(std::size_t bytes) {
    if (bytes <= largest_twin) return {};
    return Error{
        fmt::format("the recording has {:.0f} MB; a page takes {:.0f} MB at most: publish it with talus publish "
                    "and fewer frames (--interval), or without files (--no-files)",
                    static_cast<double>(bytes) / 1e6, static_cast<double>(largest_twin) / 1e6)};
}

std::string describe_twin(const scene::Scene& scene, bool engine) {
    const json about = {{"version", 1},
                        {"title", scene.spec.scene.title},
                        {"program", "talus"},
                        {"program_version", TALUS_VERSION},
                        {"made_at", utc_now()},
                        {"engine", engine},
                        {"sources", scene.spec.scene.sources}};
    return about.dump(2, ' ', false, json::error_handler_t::replace);
}

Result<Published> publish(ToPublish wanted, const SayShare& say) {
    Published made;
    TALUS_ASSIGN(made.page, published_page());
    const std::shared_ptr<const scene::Scene> scene = wanted.scene;
    const bool run = wanted.scenarios.empty();
    RecordOptions recording = wanted.recording;
    const bool engine = wanted.engine && carries_engine();
    if (engine) recording.frame_bytes = frame_bytes_with_engine;
    if (engine) TALUS_TRY(add_engine(made.content, *scene, wanted.overrides));  // before the run: it may refuse
    Hall hall;
    TALUS_TRY(hall.open(wanted));
    if (run) TALUS_TRY(run_to_end(hall.session(), say));
    TALUS_ASSIGN(const Recorded recorded, record(hall.session(), recording, say));
    made.contents = contents_of(*scene, recorded.runs);
    made.hash = recorded.runs.front().hash;
    made.content.title = scene->spec.scene.title;
    made.content.about = describe_twin(*scene, made.content.engine.has_value());
    made.content.tape = recorded.tape.pack();
    TALUS_TRY(check_twin_size(made.content.tape.size()));
    return made;
}

}  // namespace talus::serve
