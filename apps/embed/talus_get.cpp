// The functions of talus.h that read a simulation.
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/input_file.hpp"
#include "names.hpp"
#include "products/text_file.hpp"
#include "twin/answers.hpp"
#include "twin/results.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::int32_t phase_of(const Scenario& scenario) {
    switch (scenario.phase()) {
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

Result<json> json_of(const Scenario& scenario, const std::string& name) {
    if (name == "scene") return scene_json(scenario);
    if (name == "state") return state_json(scenario);
    if (name == "verdict") return verdict_json(scenario);
    if (name == "setup") return setup_json(scenario);
    if (name == "impacts") return impacts_json(scenario);
    if (name == "series") return series_json(scenario);
    if (name == "measures") return measures_json(scenario);
    if (name == "results") return results_json(scenario);
    return Error{
        fmt::format("name = \"{}\": must be scene, state, verdict, setup, impacts, series, measures or results", name)};
}

Answers::Front front_of(const Scenario& scenario) {
    Answers::Front front;
    for (const talus::observe::FrontSample& sample : scenario.run().observer().front()) {
        front.chainage.push_back(sample.chainage);
        front.arrival_time.push_back(sample.arrival_time);
        front.velocity.push_back(sample.front_velocity);
    }
    return front;
}

}  // namespace

extern "C" {

int talus_get_state(const talus_simulation* simulation, talus_state* state, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(check_size(state, "state"));
        const Scenario& scenario = *simulation->scenario;
        std::optional<std::string>& message = simulation->answers.message;
        if (!message) message = scenario.message();
        const talus::WorldPoint& origin = scenario.scene().terrain.frame().origin;
        give<talus_state>({0,
                           phase_of(scenario),
                           message->c_str(),
                           scenario.time(),
                           scenario.step(),
                           {origin.x, origin.y, origin.z},
                           scenario.run().model().particle_volume(),
                           scenario.run().observer().impacts().size()},
                          state);
        return {};
    });
}

int talus_get_hash(const talus_simulation* simulation, uint64_t* hash, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(hash, "hash"));
        *hash = talus::sim::hash_state(simulation->scenario->run().state());
        return {};
    });
}

int talus_get_debris(const talus_simulation* simulation, talus_debris* debris, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(check_size(debris, "debris"));
        const talus::sim::State& state = simulation->scenario->run().state();
        give<talus_debris>({0, state.count, state.position.x.data(), state.position.y.data(), state.position.z.data(),
                            state.velocity.x.data(), state.velocity.y.data(), state.velocity.z.data(), state.id.data(),
                            state.held.data()},
                           debris);
        return {};
    });
}

int talus_get_front(const talus_simulation* simulation, talus_front* front, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(check_size(front, "front"));
        std::optional<Answers::Front>& made = simulation->answers.front;
        if (!made) made = front_of(*simulation->scenario);
        give<talus_front>(
            {0, made->chainage.size(), made->chainage.data(), made->arrival_time.data(), made->velocity.data()}, front);
        return {};
    });
}

int talus_get_structure(const talus_simulation* simulation, size_t index, talus_structure* structure,
                        talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(check_size(structure, "structure"));
        const std::vector<talus::observe::BuildingImpact>& impacts = simulation->scenario->run().observer().impacts();
        if (index >= impacts.size()) {
            return Error{fmt::format("index = {}: there are {} structures", index, impacts.size())};
        }
        const talus::observe::BuildingImpact& impact = impacts[index];
        const std::string& name = simulation->answers.structure_names.try_emplace(index, impact.name).first->second;
        give<talus_structure>(
            {0, name.c_str(), impact.hit ? 1 : 0, impact.is_barrier ? 1 : 0, impact.first_hit_time, impact.failure_time,
             impact.peak_force, impact.peak_impact_pressure, impact.peak_depth, impact.impulse},
            structure);
        return {};
    });
}

int talus_get_json(const talus_simulation* simulation, const char* name, const char** text, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(name, "name"));
        TALUS_TRY(need(text, "json"));
        auto& texts = simulation->answers.json;
        auto found = texts.find(name);
        if (found == texts.end()) {
            TALUS_ASSIGN(const json answer, json_of(*simulation->scenario, name));
            found = texts.emplace(name, answer.dump()).first;
        }
        *text = found->second.c_str();
        return {};
    });
}

int talus_write_results(const talus_simulation* simulation, const char* folder, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(folder, "folder"));
        std::error_code problem;
        const fs::path path(folder);
        const fs::file_status there = fs::status(path, problem);
        if (fs::exists(there) && !fs::is_directory(there)) return Error{path.string() + ": is not a folder"};
        if (fs::exists(there) && !fs::is_empty(path, problem)) return Error{path.string() + ": is not empty"};
        const bool made = fs::create_directories(path, problem);
        if (problem) return Error{fmt::format("{}: cannot be created: {}", path.string(), problem.message())};
        Status written = talus::twin::products_of(*simulation->scenario)(path);
        if (written) talus::embed::tell(TALUS_LOG_INFO, fmt::format("results written into {}", path.string()));
        if (!written) {
            for (const auto& entry : fs::directory_iterator(path, problem)) fs::remove_all(entry, problem);
            if (made) fs::remove(path, problem);
        }
        return written;
    });
}

int talus_save(const talus_simulation* simulation, const char* file, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(need(simulation, "simulation"));
        TALUS_TRY(need(file, "file"));
        if (!simulation->can_be_saved) {
            return Error{"a simulation from arrays can be saved if it was opened with a folder of its own"};
        }
        TALUS_TRY(talus::check_input_file(file));
        TALUS_TRY(talus::products::replace_text_file(file, talus::twin::journal_json(*simulation->scenario).dump()));
        talus::embed::tell(TALUS_LOG_INFO, fmt::format("saved in {}", file));
        return {};
    });
}

}  // extern "C"
