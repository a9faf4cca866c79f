#include "foreign_targets.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <optional>

#include "cli/small_scene.hpp"
#include "geo/json_text.hpp"
#include "geo/zip_archive.hpp"
#include "scene/bundle.hpp"
#include "serve/draft.hpp"
#include "serve/drafts.hpp"
#include "serve/session_file.hpp"
#include "support/foreign.hpp"
#include "support/witness.hpp"

namespace talus::fuzz {
namespace {

namespace fs = std::filesystem;

/// Ends the program: this must hold for every input.
void require(bool holds, const std::string& what) {
    if (holds) return;
    std::fprintf(stderr, "does not hold: %s\n", what.c_str());
    std::abort();
}

/// What may be opened, all below one folder, and what may not, beside it.
struct Place {
    test::SmallScene scene;
    test::TemporaryFolder beside;

    [[nodiscard]] fs::path folder() const { return scene.folder(); }
};

const Place& place() {
    static const Place one;
    return one;
}

/// Whether `work` succeeds; it opens nothing outside the place.
template <class Work>
bool watched(const Work& work) {
    const test::Witness witness(place().beside.file("log"));
    const auto result = work();
    const auto elsewhere = witness.elsewhere({place().folder().string() + "/"});
    require(elsewhere.empty(), "nothing else is opened: " + (elsewhere.empty() ? "" : elsewhere.front()));
    require(result.ok() || (!result.error().message.empty() && result.error().message.size() < 5000 &&
                            result.error().message.find('\n') == std::string::npos),
            "an error is a sentence");
    return result.ok();
}

}  // namespace

bool upload(const std::string& bytes) {
    const std::size_t space = bytes.find(' '), end = bytes.find('\n');
    if (end == std::string::npos || space == std::string::npos || space > end) return false;
    std::string role = "terrain";
    for (const std::string_view known : serve::Draft::roles) {
        if (bytes.starts_with(known)) role = known;
    }
    auto draft = serve::Draft::make(place().folder() / "draft", {10'000'000, 20, 1e5});
    require(draft.ok(), "a draft is made");
    const std::string file = test::write_text((place().folder() / "draft/upload.part").string(), bytes.substr(end + 1));
    const bool taken = watched(
        [&] { return draft->take(role, bytes.substr(space + 1, end - space - 1), file, test::foreign_reader()); });
    require(!fs::exists(file), "the upload does not stay");
    if (taken) watched([&] { return draft->check({}); });
    return taken;
}

bool bundle(const std::string& bytes) {
    const fs::path archive = place().folder() / "scene.zip", unpacked = place().folder() / "unpacked";
    const fs::path mesh = fs::path(TALUS_SOURCE_DIR) / "tests/fuzz/corpus/obj/box.obj";
    require(geo::write_zip(archive, {{"scene.toml", {}, bytes + " "},
                                     {"dem.tif", place().scene.input("terrain.tif")},
                                     {"release.geojson", place().scene.input("release.geojson")},
                                     {"houses.obj", mesh}})
                .ok(),
            "the archive is packed");
    fs::path scene;
    const bool taken = watched([&]() -> Status {
        auto made = scene::unpack_bundle(archive, unpacked, {10'000'000, 20}, test::foreign_reader());
        if (!made) return made.error();
        scene = made->scene;
        return {};
    });
    require(taken || !fs::exists(unpacked), "nothing remains of what is refused");
    if (taken) watched([&] { return scene::load_scene(scene); });
    fs::remove_all(unpacked);
    return taken;
}

bool session_file(const std::string& bytes) {
    const auto file = serve::read_session(bytes);
    if (!file) return false;
    const std::string scene = place().scene.scene_file();
    const auto& overrides = file->scenarios[0].journal.overrides;
    if (!watched([&] { return scene::check_saved_overrides(scene, overrides); })) return false;
    return watched([&] { return scene::load_scene(scene, overrides); });
}

bool draft_setup(const std::string& bytes) {
    struct Page {
        serve::Executor executor;
        serve::Drafts drafts{
            executor, place().folder(), {10'000'000, 20, 1e5}, place().folder(), test::foreign_reader()};
        std::string id;

        serve::Response ask(const std::function<void(const serve::Respond&)>& question) const {
            auto answer = std::make_shared<std::promise<serve::Response>>();
            question([answer](serve::Response response) { answer->set_value(std::move(response)); });
            return answer->get_future().get();
        }
        Page() {
            id = nlohmann::json::parse(*ask([&](const auto& respond) { drafts.begin(respond); }).body)["created"];
            serve::Request request;
            request.parameters = {{"id", id}, {"role", "terrain"}};
            request.query = {{"name", "dem.tif"}};
            const auto intake = drafts.intake(request);
            std::promise<bool> written;
            intake->take(test::read_text(place().scene.input("terrain.tif")),
                         [&](std::optional<serve::Response> refused) { written.set_value(!refused); });
            require(written.get_future().get(), "the terrain comes");
            require(ask([&](const auto& respond) { intake->finish(respond); }).status == 200, "the terrain is taken");
        }
    };
    static Page page;
    serve::Request request;
    request.parameters = {{"id", page.id}};
    request.body = bytes;
    const auto outcome = [](const serve::Response& response) -> Status {
        if (response.status == 200) return {};
        return Error{nlohmann::json::parse(*response.body)["error"].get<std::string>()};
    };
    const bool mended =
        watched([&] { return outcome(page.ask([&](const auto& respond) { page.drafts.mend(request, respond); })); });
    auto body = geo::parse_json(bytes);
    if (!body || !body->is_object()) return mended;
    (*body)["check"] = true;  // otherwise the draft is gone
    request.body = body->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    return watched(
               [&] { return outcome(page.ask([&](const auto& respond) { page.drafts.make(request, respond); })); }) ||
           mended;
}

}  // namespace talus::fuzz
