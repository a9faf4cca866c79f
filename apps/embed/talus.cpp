// The functions of talus.h that make and change a simulation; those that read one are in talus_get.cpp.
#include "talus.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "call.hpp"
#include "core/input_file.hpp"
#include "core/temporary_folder.hpp"
#include "core/try.hpp"
#include "geo/json_text.hpp"
#include "handle.hpp"
#include "scene/builtin.hpp"
#include "scene/bundle.hpp"
#include "scene/scene.hpp"
#include "scene_folder.hpp"
#include "twin/journal.hpp"
#include "twin/scenario.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using talus::Error;
using talus::Result;
using talus::Status;
using talus::embed::Changing;
using talus::embed::check_size;
using talus::embed::guarded;
using talus::embed::need;
using talus::embed::tell;
using talus::embed::Watch;
using talus::twin::Scenario;

constexpr double no_frames = 1e9;  // s between recorded frames, which only the live page shows
constexpr std::uintmax_t largest_saved = 64U << 20U;

Result<std::vector<std::string>> texts_of(const char* const* settings, std::size_t count) {
    constexpr std::size_t most = 10'000;
    if (count > most) return Error{fmt::format("setting_count = {}: must be at most {}", count, most)};
    if (count > 0) TALUS_TRY(need(static_cast<const void*>(settings), "settings"));
    std::vector<std::string> texts;
    for (std::size_t k = 0; k < count; ++k) {
        if (settings[k] == nullptr) return Error{fmt::format("settings[{}] is NULL", k)};
        texts.emplace_back(settings[k]);
    }
    return texts;
}

void give(std::unique_ptr<Scenario> scenario, bool can_be_saved, talus_simulation** simulation) {
    const Scenario& opened = *scenario;
    auto made = std::make_unique<talus_simulation>();
    made->scenario = std::move(scenario);
    made->can_be_saved = can_be_saved;
    for (const std::string& note : opened.scene().notes) tell(TALUS_LOG_WARNING, note);
    tell(TALUS_LOG_INFO,
         fmt::format("opened \"{}\" at t = {:.4g} s: {} particles of {:.3g} m3", opened.scene().spec.scene.title,
                     opened.time(), opened.run().state().count, opened.run().model().particle_volume()));
    *simulation = made.release();
}

/// The longest step that may come next, s.
double longest_step(const Scenario& scenario) {
    const talus::sim::Model& model = scenario.run().model();
    return model.solver.time_step.value_or(model.largest_time_step());
}

/// Keeps where the debris is before a step that may reach a time, for talus_get_debris_at().
void keep_before(talus_simulation& simulation) {
    const talus::sim::State& state = simulation.scenario->run().state();
    if (!simulation.before) simulation.before.emplace();
    talus::embed::Before& before = *simulation.before;
    before.step = state.step;
    before.time = state.time;
    before.of_id.assign(state.seeded, {});
    for (std::uint32_t i = 0; i < state.count; ++i) {
        before.of_id[state.id[i]] = {state.position.at(i), state.velocity.at(i), true};
    }
}

Status open_scene(talus::scene::Scene loaded, std::vector<std::string> settings, bool can_be_saved, Watch& watch,
                  talus_simulation** simulation) {
    leave_out_zoom(loaded, "a simulation step by step");
    if (!watch.go_on(0)) return {};
    const auto scene = std::make_shared<const talus::scene::Scene>(std::move(loaded));
    TALUS_ASSIGN(auto scenario, Scenario::open(scene, {std::move(settings), no_frames, 0},
                                               [&](double share) { return watch.go_on(share); }));
    give(std::move(scenario), can_be_saved, simulation);
    return {};
}

Result<talus::scene::Scene> load_builtin(const std::vector<std::string>& settings) {
    const talus::TemporaryFolder unpacked;
    if (unpacked.path().empty()) return Error{"cannot make a temporary folder for the built-in scene; set TMPDIR"};
    return talus::scene::load_builtin_scene(unpacked.path(), settings);
}

/// The scene of a saved simulation. Somebody else may have saved it: its settings name no file that the scene does not.
Result<talus::scene::Scene> load_saved(const talus::twin::Journal& journal) {
    if (!journal.scene_file.starts_with("built-in:")) {
        TALUS_TRY(talus::scene::check_saved_overrides(journal.scene_file, journal.overrides));
        return talus::scene::load_scene(journal.scene_file, journal.overrides);
    }
    const talus::TemporaryFolder unpacked;
    if (unpacked.path().empty()) return Error{"cannot make a temporary folder for the built-in scene; set TMPDIR"};
    TALUS_ASSIGN(const fs::path scene, talus::scene::unpack_builtin_scene(unpacked.path()));
    TALUS_TRY(talus::scene::check_saved_overrides(scene, journal.overrides));
    return talus::scene::load_builtin_scene(unpacked.path(), journal.overrides);
}

/// The text of a file that was saved.
Result<std::string> read_file(const char* path) {
    TALUS_TRY(talus::check_input_file(path));
    std::error_code problem;
    if (fs::is_directory(path, problem)) return Error{fmt::format("{}: is a folder; it must be a file", path)};
    std::ifstream file(path, std::ios::binary);
    if (!file) return Error{fmt::format("{}: cannot be opened", path)};
    const std::uintmax_t size = fs::file_size(path, problem);
    if (problem || size > largest_saved) {
        return Error{fmt::format("{}: has {} bytes; a saved simulation has at most {}", path, size, largest_saved)};
    }
    std::string text(size, '\0');
    file.read(text.data(), static_cast<std::streamsize>(size));
    text.resize(static_cast<std::size_t>(file.gcount()));  // it may have been cut since
    return text;
}

/// `share`: of the work that is done. `another`: whether a step is to be taken, and what is to be done before it.
template <class Share, class Another>
int take_steps(talus_simulation* simulation, const talus_progress* progress, talus_error* error, const Share& share,
               const Another& another) {
    Watch watch(progress);
    bool fault = false;
    const int code = guarded(
        error,
        [&]() -> Status {
            Scenario& scenario = *simulation->scenario;
            const Changing changing(*simulation);
            while (scenario.phase() == talus::run::RunPhase::ready && another(scenario)) {
                simulation->answers = {};  // that the caller's function asked for after the last step
                if (!watch.go_on(share(scenario))) return {};
                simulation->answers = {};
                scenario.advance();
                const auto phase = scenario.phase();
                if (phase == talus::run::RunPhase::at_rest || phase == talus::run::RunPhase::ended) {
                    tell(TALUS_LOG_INFO, fmt::format("t = {:.4g} s: {}", scenario.time(), scenario.message()));
                }
            }
            fault = scenario.phase() == talus::run::RunPhase::fault;
            if (fault) return Error{scenario.message()};
            return {};
        },
        &watch);
    if (fault && code == TALUS_BAD_INPUT && error != nullptr) error->code = TALUS_FAULT;
    return fault && code == TALUS_BAD_INPUT ? TALUS_FAULT : code;
}

void note_change(talus_simulation& simulation, const talus::twin::Done& done) {
    simulation.before.reset();
    tell(TALUS_LOG_INFO, fmt::format("t = {:.4g} s: {}", simulation.scenario->time(), done.sentence));
}

/// What both ways to take steps need.
Status check_steps(const talus_simulation* simulation, const talus_progress* progress) {
    TALUS_TRY(Changing::check(simulation));
    return Watch(progress).check();
}

}  // namespace

extern "C" {

static_assert(TALUS_VERSION_MAJOR == TALUS_PROJECT_MAJOR && TALUS_VERSION_MINOR == TALUS_PROJECT_MINOR &&
              TALUS_VERSION_PATCH == TALUS_PROJECT_PATCH);

const char* talus_version(void) {
    return TALUS_VERSION;
}

int talus_open(const char* scene_file, const char* const* settings, size_t setting_count,
               const talus_progress* progress, talus_simulation** simulation, talus_error* error) {
    Watch watch(progress);
    return guarded(
        error,
        [&]() -> Status {
            TALUS_TRY(need(static_cast<void*>(simulation), "simulation"));
            TALUS_TRY(watch.check());
            TALUS_ASSIGN(std::vector<std::string> texts, texts_of(settings, setting_count));
            if (!watch.go_on(0)) return {};
            TALUS_ASSIGN(talus::scene::Scene scene,
                         scene_file == nullptr ? load_builtin(texts) : talus::scene::load_scene(scene_file, texts));
            return open_scene(std::move(scene), std::move(texts), true, watch, simulation);
        },
        &watch);
}

int talus_open_arrays(const talus_arrays* arrays, const char* folder, const char* const* settings, size_t setting_count,
                      const talus_progress* progress, talus_simulation** simulation, talus_error* error) {
    Watch watch(progress);
    return guarded(
        error,
        [&]() -> Status {
            TALUS_TRY(check_size(arrays, "arrays"));
            TALUS_TRY(need(static_cast<void*>(simulation), "simulation"));
            TALUS_TRY(watch.check());
            TALUS_ASSIGN(std::vector<std::string> texts, texts_of(settings, setting_count));
            if (!watch.go_on(0)) return {};
            const talus::TemporaryFolder temporary;
            if (folder == nullptr && temporary.path().empty()) {
                return Error{"cannot make a temporary folder for the scene; set TMPDIR"};
            }
            TALUS_ASSIGN(auto written, talus::embed::SceneFolder::write(
                                           *arrays, folder != nullptr ? fs::path(folder) : temporary.path()));
            auto scene = talus::scene::load_scene(written.scene_file(), texts);
            const Status opened =
                scene ? open_scene(*std::move(scene), std::move(texts), folder != nullptr, watch, simulation)
                      : Status(scene.error());
            if (!opened) return Error{written.in_words_of_arrays(opened.error().message)};
            if (!watch.cancelled()) written.keep();
            return {};
        },
        &watch);
}

void talus_close(talus_simulation* simulation) {
    delete simulation;  // NOLINT(cppcoreguidelines-owning-memory): C owns it
}

int talus_step(talus_simulation* simulation, uint64_t steps, const talus_progress* progress, talus_error* error) {
    const int ready = guarded(error, [&] { return check_steps(simulation, progress); });
    if (ready != TALUS_OK) return ready;
    const uint64_t start = simulation->scenario->step(),
                   wanted = std::min(steps, std::numeric_limits<uint64_t>::max() - start);
    return take_steps(
        simulation, progress, error,
        [&](const Scenario& s) { return static_cast<double>(s.step() - start) / static_cast<double>(wanted); },
        [&](const Scenario& s) { return s.step() - start < wanted; });
}

int talus_advance(talus_simulation* simulation, double time, const talus_progress* progress, talus_error* error) {
    const int ready = guarded(error, [&]() -> Status {
        TALUS_TRY(check_steps(simulation, progress));
        if (!(time >= 0)) return Error{fmt::format("time = {}: must be 0 or more", time)};
        return {};
    });
    if (ready != TALUS_OK) return ready;
    const double start = simulation->scenario->time(),
                 end = std::min(time, simulation->scenario->run().model().solver.end_time);
    return take_steps(
        simulation, progress, error, [&](const Scenario& s) { return (s.time() - start) / (end - start); },
        [&](const Scenario& s) {
            if (!(s.time() < time)) return false;
            if (s.time() + longest_step(s) >= time) keep_before(*simulation);
            return true;
        });
}

int talus_set(talus_simulation* simulation, const char* key, double value, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(Changing::check(simulation));
        TALUS_TRY(need(key, "key"));
        if (!std::isfinite(value)) return Error{fmt::format("{} = {}: must be a finite number", key, value)};
        const Changing changing(*simulation);
        TALUS_ASSIGN(
            const talus::twin::Done done,
            simulation->scenario->apply({{"action", "set_parameter"}, {"key", key}, {"value", value}}, "talus.h"));
        note_change(*simulation, done);
        return {};
    });
}

int talus_apply(talus_simulation* simulation, const char* action, const char** created, talus_error* error) {
    return guarded(error, [&]() -> Status {
        TALUS_TRY(Changing::check(simulation));
        TALUS_TRY(need(action, "action"));
        const auto parsed = talus::geo::parse_json(action);
        if (!parsed) return Error{"action: " + parsed.error().message};
        const Changing changing(*simulation);
        TALUS_ASSIGN(talus::twin::Done done, simulation->scenario->apply(*parsed, "talus.h"));
        note_change(*simulation, done);
        simulation->answers.created = std::move(done.created);
        if (created != nullptr) *created = simulation->answers.created.c_str();
        return {};
    });
}

int talus_open_saved(const char* file, const talus_progress* progress, talus_simulation** simulation,
                     talus_error* error) {
    Watch watch(progress);
    return guarded(
        error,
        [&]() -> Status {
            TALUS_TRY(need(file, "file"));
            TALUS_TRY(need(static_cast<void*>(simulation), "simulation"));
            TALUS_TRY(watch.check());
            TALUS_ASSIGN(const std::string text, read_file(file));
            const auto journal = talus::twin::read_journal(text);
            if (!journal) return Error{fmt::format("{}: {}", file, journal.error().message)};
            if (!watch.go_on(0)) return {};
            TALUS_ASSIGN(talus::scene::Scene scene, load_saved(*journal));
            for (const std::string& changed : talus::twin::changed_inputs(*journal, scene)) return Error{changed};
            if (!watch.go_on(0)) return {};
            auto again = talus::twin::replay(
                *journal, std::make_shared<const talus::scene::Scene>(std::move(scene)), [&](std::uint64_t step) {
                    return watch.go_on(static_cast<double>(step) / static_cast<double>(journal->steps));
                });
            if (watch.cancelled()) return {};
            if (!again) return Error{fmt::format("{}: {}", file, again.error().message)};
            if (again->hash != journal->hash) {
                return Error{fmt::format("{}: the state at its end differs from the one that was saved", file)};
            }
            give(std::move(again->scenario), true, simulation);
            return {};
        },
        &watch);
}

}  // extern "C"
