#include "talus.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "products/text_file.hpp"
#include "scene/builtin.hpp"
#include "scene/scene.hpp"
#include "scene_folder.hpp"
#include "twin/journal.hpp"
#include "twin/scenario.hpp"

/// What the pointers that are returned point to, beside the scenario.
struct talus_simulation {
    std::unique_ptr<talus::twin::Scenario> scenario;
    bool can_be_saved = true;
    std::string text, created, structure_name;
    std::map<std::string, talus::Grid<float>> maps;
    std::vector<double> chainage, arrival_time, velocity;
};

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using talus::Error;
using talus::Result;
using talus::Status;
using talus::twin::Scenario;

constexpr double no_frames = 1e9;  // s between recorded frames, which only the live page shows

/// Answers with a code; nothing that is thrown leaves the library.
template <class Work>
int guarded(talus_error* error, const Work& work) {
    const auto say = [&](int code, const char* text) {
        if (error != nullptr) {
            error->code = code;
            (void)std::snprintf(error->text, sizeof error->text, "%s", text);
        }
        return code;
    };
    try {
        const Status status = work();
        return status ? say(TALUS_OK, "") : say(TALUS_BAD_INPUT, status.error().message.c_str());
    } catch (const std::bad_alloc&) {
        return say(TALUS_FAILURE, "out of memory");
    } catch (const std::exception& thrown) {
        return say(TALUS_FAILURE, thrown.what());
    } catch (...) {
        return say(TALUS_FAILURE, "an error of no known kind");
    }
}

Result<std::vector<std::string>> texts_of(const char* const* settings, std::size_t count) {
    std::vector<std::string> texts;
    for (std::size_t k = 0; k < count; ++k) {
        if (settings == nullptr || settings[k] == nullptr) return Error{fmt::format("settings[{}] is NULL", k)};
        texts.emplace_back(settings[k]);
    }
    return texts;
}

Status give(std::unique_ptr<Scenario> scenario, bool can_be_saved, talus_simulation** simulation) {
    auto made = std::make_unique<talus_simulation>();
    made->scenario = std::move(scenario);
    made->can_be_saved = can_be_saved;
    *simulation = made.release();
    return {};
}

Status open_scene(talus::scene::Scene loaded, std::vector<std::string> settings, bool can_be_saved,
                  talus_simulation** simulation) {
    leave_out_zoom(loaded, "a simulation step by step");
    const auto scene = std::make_shared<const talus::scene::Scene>(std::move(loaded));
    TALUS_ASSIGN(auto scenario, Scenario::open(scene, {std::move(settings), no_frames, 0}));
    return give(std::move(scenario), can_be_saved, simulation);
}

Result<talus::scene::Scene> load_builtin(const std::vector<std::string>& settings) {
    const talus::TemporaryFolder unpacked;
    if (unpacked.path().empty()) return Error{"cannot make a temporary folder for the built-in scene; set TMPDIR"};
    return talus::scene::load_builtin_scene(unpacked.path(), settings);
}

/// The text of a file that was saved.
Result<std::string> read_file(const char* path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return Error{fmt::format("{}: cannot be opened", path)};
    return std::string{std::istreambuf_iterator<char>(file), {}};
}

template <class Advance>
int take_steps(talus_simulation& simulation, talus_error* error, const Advance& another) {
    Scenario& scenario = *simulation.scenario;
    const int code = guarded(error, [&]() -> Status {
        while (scenario.phase() == talus::run::RunPhase::ready && another(scenario)) scenario.advance();
        return {};
    });
    if (code != TALUS_OK || scenario.phase() != talus::run::RunPhase::fault) return code;
    (void)guarded(error, [&]() -> Status { return Error{scenario.message()}; });
    if (error != nullptr) error->code = TALUS_FAULT;
    return TALUS_FAULT;
}

}  // namespace

extern "C" {

const char* talus_version(void) {
    return TALUS_VERSION;
}

int talus_open(const char* scene_file, const char* const* settings, size_t setting_count, talus_simulation** simulation,
               talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_ASSIGN(std::vector<std::string> texts, texts_of(settings, setting_count));
        TALUS_ASSIGN(talus::scene::Scene scene,
                     scene_file == nullptr ? load_builtin(texts) : talus::scene::load_scene(scene_file, texts));
        return open_scene(std::move(scene), std::move(texts), true, simulation);
    });
}

int talus_open_arrays(const talus_arrays* arrays, const char* folder, const char* const* settings, size_t setting_count,
                      talus_simulation** simulation, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_ASSIGN(std::vector<std::string> texts, texts_of(settings, setting_count));
        const talus::TemporaryFolder temporary;
        const fs::path kept = folder != nullptr ? fs::path(folder) : temporary.path();
        if (kept.empty()) return Error{"cannot make a temporary folder for the scene; set TMPDIR"};
        TALUS_ASSIGN(const fs::path file, talus::embed::write_scene_folder(*arrays, kept));
        TALUS_ASSIGN(talus::scene::Scene scene, talus::scene::load_scene(file, texts));
        return open_scene(std::move(scene), std::move(texts), folder != nullptr, simulation);
    });
}

void talus_close(talus_simulation* simulation) {
    delete simulation;  // NOLINT(cppcoreguidelines-owning-memory): C owns it
}

int talus_step(talus_simulation* simulation, uint64_t steps, talus_error* error) {
    const uint64_t end = simulation->scenario->step() + steps;
    return take_steps(*simulation, error, [&](const Scenario& s) { return s.step() < end; });
}

int talus_advance(talus_simulation* simulation, double time, talus_error* error) {
    return take_steps(*simulation, error, [&](const Scenario& s) { return s.time() < time; });
}

talus_phase talus_get_phase(const talus_simulation* simulation) {
    switch (simulation->scenario->phase()) {
        case talus::run::RunPhase::ready:
            return TALUS_READY;
        case talus::run::RunPhase::at_rest:
            return TALUS_AT_REST;
        case talus::run::RunPhase::ended:
            return TALUS_ENDED;
        case talus::run::RunPhase::fault:
            break;
    }
    return TALUS_STOPPED;
}

const char* talus_message(talus_simulation* simulation) {
    simulation->text = simulation->scenario->message();
    return simulation->text.c_str();
}

double talus_time(const talus_simulation* simulation) {
    return simulation->scenario->time();
}

uint64_t talus_steps(const talus_simulation* simulation) {
    return simulation->scenario->step();
}

uint64_t talus_hash(const talus_simulation* simulation) {
    return simulation->scenario->hash();
}

void talus_origin(const talus_simulation* simulation, double x_y_z[3]) {
    const talus::WorldPoint& origin = simulation->scenario->scene().terrain.frame().origin;
    x_y_z[0] = origin.x;
    x_y_z[1] = origin.y;
    x_y_z[2] = origin.z;
}

double talus_particle_volume(const talus_simulation* simulation) {
    return simulation->scenario->model().particle_volume();
}

talus_debris talus_get_debris(const talus_simulation* simulation) {
    const talus::sim::State& state = simulation->scenario->state();
    return {state.count,
            state.position.x.data(),
            state.position.y.data(),
            state.position.z.data(),
            state.velocity.x.data(),
            state.velocity.y.data(),
            state.velocity.z.data(),
            state.id.data(),
            state.held.data()};
}

int talus_get_map(talus_simulation* simulation, const char* name, talus_map* map, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_ASSIGN(const auto layer, simulation->scenario->layer(name));
        talus::Grid<float>& grid = simulation->maps[name];
        grid = layer();
        const talus::GridGeometry& g = grid.geometry;
        *map = {{g.x_min, g.y_min, g.cell, g.columns, g.rows}, grid.values.data()};
        return {};
    });
}

talus_front talus_get_front(talus_simulation* simulation) {
    simulation->chainage.clear();
    simulation->arrival_time.clear();
    simulation->velocity.clear();
    for (const talus::observe::FrontSample& sample : simulation->scenario->observer().front()) {
        simulation->chainage.push_back(sample.chainage);
        simulation->arrival_time.push_back(sample.arrival_time);
        simulation->velocity.push_back(sample.front_velocity);
    }
    return {simulation->chainage.size(), simulation->chainage.data(), simulation->arrival_time.data(),
            simulation->velocity.data()};
}

size_t talus_structure_count(const talus_simulation* simulation) {
    return simulation->scenario->observer().impacts().size();
}

int talus_get_structure(talus_simulation* simulation, size_t index, talus_structure* structure, talus_error* error) {
    return guarded(error, [&]() -> Status {
        const std::vector<talus::observe::BuildingImpact>& impacts = simulation->scenario->observer().impacts();
        if (index >= impacts.size()) {
            return Error{fmt::format("index = {}: there are {} structures", index, impacts.size())};
        }
        const talus::observe::BuildingImpact& impact = impacts[index];
        simulation->structure_name = impact.name;
        *structure = {simulation->structure_name.c_str(),
                      impact.hit ? 1 : 0,
                      impact.is_barrier ? 1 : 0,
                      impact.first_hit_time,
                      impact.failure_time,
                      impact.peak_force,
                      impact.peak_impact_pressure,
                      impact.peak_depth,
                      impact.impulse};
        return {};
    });
}

int talus_set(talus_simulation* simulation, const char* key, double value, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(
            simulation->scenario->apply({{"action", "set_parameter"}, {"key", key}, {"value", value}}, "talus.h"));
        return {};
    });
}

int talus_apply(talus_simulation* simulation, const char* action, const char** created, talus_error* error) {
    return guarded(error, [&]() -> Status {
        const json parsed = json::parse(action, nullptr, false);
        if (parsed.is_discarded()) return Error{"the action is not JSON"};
        TALUS_ASSIGN(talus::twin::Done done, simulation->scenario->apply(parsed, "talus.h"));
        simulation->created = std::move(done.created);
        if (created != nullptr) *created = simulation->created.c_str();
        return {};
    });
}

int talus_get_json(talus_simulation* simulation, const char* name, const char** text, talus_error* error) {
    return guarded(error, [&]() -> Status {
        const Scenario& scenario = *simulation->scenario;
        const std::string wanted = name;
        json answer;
        if (wanted == "scene") {
            answer = scenario.scene_json();
        } else if (wanted == "state") {
            answer = scenario.state_json();
        } else if (wanted == "verdict") {
            answer = scenario.verdict_json();
        } else if (wanted == "setup") {
            answer = scenario.setup_json();
        } else if (wanted == "impacts") {
            answer = scenario.impacts_json();
        } else if (wanted == "series") {
            answer = scenario.series_json();
        } else {
            return Error{fmt::format("name = \"{}\": must be scene, state, verdict, setup, impacts or series", wanted)};
        }
        simulation->text = answer.dump();
        *text = simulation->text.c_str();
        return {};
    });
}

int talus_write_results(talus_simulation* simulation, const char* folder, talus_error* error) {
    return guarded(error, [&]() -> Status {
        std::error_code problem;
        const fs::path path(folder);
        if (fs::exists(path, problem) && !fs::is_empty(path, problem)) return Error{path.string() + ": is not empty"};
        const bool made = fs::create_directories(path, problem);
        if (problem) return Error{fmt::format("{}: cannot be created: {}", path.string(), problem.message())};
        Status written = simulation->scenario->products()(path);
        if (!written) {
            for (const auto& entry : fs::directory_iterator(path, problem)) fs::remove_all(entry, problem);
            if (made) fs::remove(path, problem);
        }
        return written;
    });
}

int talus_save(talus_simulation* simulation, const char* file, talus_error* error) {
    return guarded(error, [&]() -> Status {
        if (!simulation->can_be_saved) {
            return Error{"a simulation from arrays can be saved if it was opened with a folder of its own"};
        }
        return talus::products::write_text_file(file, simulation->scenario->journal_json().dump());
    });
}

int talus_open_saved(const char* file, talus_simulation** simulation, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_ASSIGN(const std::string text, read_file(file));
        const auto journal = talus::twin::read_journal(text);
        if (!journal) return Error{fmt::format("{}: {}", file, journal.error().message)};
        const bool builtin = journal->scene_file.starts_with("built-in:");
        TALUS_ASSIGN(talus::scene::Scene scene,
                     builtin ? load_builtin(journal->overrides)
                             : talus::scene::load_scene(journal->scene_file, journal->overrides));
        for (const std::string& changed : talus::twin::changed_inputs(*journal, scene)) return Error{changed};
        TALUS_ASSIGN(talus::twin::Replayed again,
                     talus::twin::replay(*journal, std::make_shared<const talus::scene::Scene>(std::move(scene))));
        if (again.hash != journal->hash) {
            return Error{fmt::format("{}: the state at its end differs from the one that was saved", file)};
        }
        return give(std::move(again.scenario), true, simulation);
    });
}

}  // extern "C"
