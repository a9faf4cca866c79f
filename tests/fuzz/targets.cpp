#include "targets.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <sstream>

#include "cli/small_scene.hpp"
#include "core/hash.hpp"
#include "ensemble/plan.hpp"
#include "ensemble/run_record.hpp"
#include "foreign_targets.hpp"
#include "geo/json_text.hpp"
#include "geo/mesh.hpp"
#include "pack/pack.hpp"
#include "scene/hydrograph.hpp"
#include "scene/scene.hpp"
#include "serve/client.hpp"
#include "serve/server.hpp"
#include "session/json_text.hpp"
#include "session/url.hpp"
#include "support/fixtures.hpp"
#include "twin/journal.hpp"
#include "twin/setup_file.hpp"
#include "twin/twin_fixtures.hpp"

namespace talus::fuzz {
namespace {

/// Ends the program: this must hold for every input.
void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "does not hold: %s\n", what);
    std::abort();
}

/// The bytes as a file of that name.
std::string as_file(const char* name, const std::string& bytes) {
    static const test::TemporaryFolder folder;
    return test::write_text(folder.file(name), bytes);
}

template <class T>
bool read_or_refused(const Result<T>& result) {
    require(result.ok() || (!result.error().message.empty() && result.error().message.size() < 5000),
            "an error is a sentence");
    return result.ok();
}

bool scene_toml(const std::string& bytes) {
    return read_or_refused(scene::parse_scene(as_file("scene.toml", bytes), {}));
}

bool plan_toml(const std::string& bytes) {
    return read_or_refused(ensemble::read_plan(as_file("plan.toml", bytes)));
}

bool hydrograph(const std::string& bytes) {
    params::InflowSpec inflow;
    inflow.hydrograph = as_file("hydrograph.csv", bytes);
    const auto rows = scene::read_hydrograph(inflow);
    read_or_refused(rows);
    for (std::size_t k = 0; rows && k < rows->size(); ++k) {
        require(std::isfinite((*rows)[k].discharge) && (*rows)[k].discharge >= 0, "a discharge is finite");
        require(k == 0 || (*rows)[k].time > (*rows)[k - 1].time, "times ascend");
    }
    return rows.ok();
}

bool mesh(const char* name, const std::string& bytes) {
    std::vector<std::string> more_files;
    const auto buildings = geo::read_mesh_buildings(as_file(name, bytes), {"", "", 2326}, more_files);
    read_or_refused(buildings);
    if (!buildings) return false;
    for (const geo::MeshBuilding& building : *buildings) {
        require(!building.roofs.empty(), "a building has a roof");
        for (const geo::RoofFace& roof : building.roofs) require(std::isfinite(roof.elevation), "roofs are finite");
    }
    return true;
}
bool gltf(const std::string& bytes) {
    return mesh("a.gltf", bytes);
}
bool glb(const std::string& bytes) {
    return mesh("a.glb", bytes);
}
bool obj(const std::string& bytes) {
    return mesh("a.obj", bytes);
}
bool city_json(const std::string& bytes) {
    return mesh("a.city.json", bytes);
}

bool json_text(const std::string& bytes) {
    const auto read = geo::parse_json(bytes);
    read_or_refused(read);
    if (read) require(geo::parse_json(read->dump(-1, ' ', true)).ok(), "what was read can be written and read");
    (void)session::tidy_name(bytes, 40);
    return read.ok();
}

bool url(const std::string& bytes) {
    return read_or_refused(session::parse_target(bytes));
}

bool journal(const std::string& bytes) {
    const auto read = twin::read_journal(bytes);
    read_or_refused(read);
    if (read) require(twin::read_journal(write_journal(*read).dump()).ok(), "what was read can be written and read");
    return read.ok();
}

/// A scene of few particles.
std::shared_ptr<const scene::Scene> channel() {
    static const auto scene = [] {
        scene::Scene made = twin::test::channel_scene();
        made.spec.solver.particle_spacing = 1.5;
        made.spec.solver.thread_count = 1;
        return std::make_shared<const scene::Scene>(std::move(made));
    }();
    return scene;
}

bool setup(const std::string& bytes) {
    const auto file = geo::parse_json(bytes);
    return file && read_or_refused(twin::read_setup(*file, *channel()));
}

/// An action per line, with a few steps between them; then the session again from its journal.
bool actions(const std::string& bytes) {
    auto opened = twin::Scenario::open(channel());
    require(opened.ok(), "the scene opens");
    twin::Scenario& scenario = **opened;
    std::istringstream lines(bytes);
    std::string line;
    int done_count = 0;
    for (int count = 0; count < 12 && std::getline(lines, line); ++count) {
        const auto action = geo::parse_json(line);
        if (!action) continue;
        const auto done = scenario.apply(*action, "Ann");
        done_count += read_or_refused(done) ? 1 : 0;
        for (int step = 0; step < 3; ++step) scenario.advance();
        (void)setup_json(scenario);
    }
    if (scenario.phase() == run::RunPhase::fault) return done_count > 0;
    const auto state = state_json(scenario);
    for (const char* key : {"volume_released_m3", "volume_moving_m3", "largest_speed_mps"}) {
        require(state[key].is_number() && std::isfinite(state[key].get<double>()), key);
    }
    const auto told = twin::read_journal(journal_json(scenario).dump());
    require(told.ok(), "a session's own journal is read");
    const auto replayed = twin::replay(*told, channel(), {});
    require(replayed && replayed->hash == to_hex(hash_state(scenario.run().state())),
            "a replay ends in the same state");
    return done_count > 0;
}

/// With the checksum that it should have: what a damaged file cannot have.
bool run_record(const std::string& bytes) {
    StateHash sum;
    sum.add(bytes.data(), bytes.size());
    const std::string file = as_file("000001.run", "talus run 2 " + to_hex(sum.value()) + "\n" + bytes);
    const auto record = ensemble::read_run_record(file, "plan", 1);
    read_or_refused(record);
    for (std::size_t map = 0; record && map < ensemble::recorded_maps.size(); ++map) {
        read_or_refused(ensemble::read_map_rows(file, *record, map, 0, record->geometry.rows));
    }
    return record.ok();
}

bool run_record_file(const std::string& bytes) {
    return read_or_refused(ensemble::read_run_record(as_file("000001.run", bytes), "plan", 1));
}

/// A server for all inputs of this process.
class LiveServer {
  public:
    LiveServer() {
        auto scene = scene::load_scene(scene_.scene_file());
        require(scene.ok(), "the scene loads");
        serve::ServerOptions options;
        options.port = 0;
        options.tokens = {controller, "viewer-token-of-the-tests"};
        options.export_folder = scene_.folder();
        auto server = serve::Server::listen(std::move(options));
        require(server && (*server)->serve(std::make_shared<const scene::Scene>(std::move(*scene))), "it serves");
        server_ = std::move(*server);
    }
    /// Sends it on a new connection, and asks on another one whether all is well.
    void take(std::string bytes, bool websocket) const {
        const std::string port = ":8123";  // of the corpus
        if (const auto at = bytes.find(port); at != std::string::npos && !websocket) {
            bytes.replace(at, port.size(), ":" + std::to_string(server_->port()));
        }
        if (websocket) {
            test::WebSocket viewer(server_->port(), std::string("token=") + controller);
            viewer.socket().send(bytes);
            (void)viewer.receive(test::Milliseconds(2));
        } else {
            test::Socket socket(server_->port());
            socket.send(bytes);
            (void)socket.receive(test::Milliseconds(2));
        }
        test::HttpClient client(server_->port(), controller);
        require(client.get("/api/session").status == 200, "the server answers others");
    }

  private:
    static constexpr const char* controller = "controller-token-of-tests";
    test::SmallScene scene_;
    std::unique_ptr<serve::Server> server_;
};

const LiveServer& server() {
    static const LiveServer live;
    return live;
}
/// The whole file, and as if its hash were right. The corpus is what test_pack writes to TALUS_PACKS_TO; another
/// version of the format needs it anew.
bool packed_scene(const std::string& bytes) {
    const bool whole = read_or_refused(pack::read(std::as_bytes(std::span(bytes)), "twin.talus"));
    return read_or_refused(pack::read_content(bytes, "twin.talus")) || whole;
}

bool http(const std::string& bytes) {
    server().take(bytes, false);
    return true;
}
bool websocket(const std::string& bytes) {
    server().take(bytes, true);
    return true;
}

constexpr std::array all = {Target{"scene_toml", scene_toml},
                            Target{"plan_toml", plan_toml},
                            Target{"hydrograph", hydrograph},
                            Target{"gltf", gltf},
                            Target{"glb", glb},
                            Target{"obj", obj},
                            Target{"city_json", city_json},
                            Target{"json_text", json_text},
                            Target{"url", url},
                            Target{"journal", journal},
                            Target{"setup", setup},
                            Target{"actions", actions},
                            Target{"run_record", run_record},
                            Target{"run_record_file", run_record_file},
                            Target{"upload", upload},
                            Target{"bundle", bundle},
                            Target{"session_file", session_file},
                            Target{"draft_setup", draft_setup},
                            Target{"packed_scene", packed_scene},
                            Target{"http", http},
                            Target{"websocket", websocket}};

}  // namespace

std::span<const Target> targets() {
    return all;
}

}  // namespace talus::fuzz
