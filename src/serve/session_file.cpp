#include "serve/session_file.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "messages/messages.hpp"
#include "run/threads.hpp"
#include "serve/library.hpp"
#include "session/json_text.hpp"
#include "twin/answers.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr int session_version = 1;

Result<std::string> needed_text(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_string()) return Error{fmt::format("{}: missing; it must be a text", key)};
    return found->get<std::string>();
}

Result<SavedScenario> read_scenario(const json& written) {
    if (!written.is_object()) return Error{"must be an object"};
    TALUS_TRY(twin::check_keys(written, {"name", "title", "journal"}));
    SavedScenario scenario;
    TALUS_ASSIGN(const auto name, needed_text(written, "name"));
    TALUS_ASSIGN(scenario.title, needed_text(written, "title"));
    while (scenario.index < Scenarios::max_count && name != Scenarios::name_of(scenario.index)) ++scenario.index;
    if (scenario.index == Scenarios::max_count) {
        return Error{fmt::format("name = \"{}\": must be A to F", tidy_name(name, 20))};
    }
    TALUS_ASSIGN(scenario.journal, twin::read_journal(written.value("journal", json()).dump()));
    return scenario;
}

}  // namespace

json write_session(Scenarios& all, const std::string& name, const std::string& title, const json& laid) {
    const std::vector<std::string> names = all.names();
    std::vector<messages::SavedScenario> scenarios;
    scenarios.reserve(names.size());
    for (const std::string& letter : names) {
        const int index = *all.find(letter);
        scenarios.push_back({.name = letter, .title = all.title(index), .journal = twin::journal_json(all.at(index))});
    }
    json session = messages::SessionFile{.talus_session = session_version,
                                         .name = name,
                                         .title = title,
                                         .saved_at = utc_now(),
                                         .scenarios = std::move(scenarios)};
    session.update(laid);
    return session;
}

Result<SessionFile> read_session(const std::string& text) {
    TALUS_ASSIGN(const json written, parse_json(text, Library::most_session_values));
    if (!written.is_object() || !written.contains("talus_session")) {
        return Error{"talus_session: missing; this is no saved session"};
    }
    if (written["talus_session"] != session_version) {
        return Error{fmt::format("talus_session = {}: this program reads version {}", written["talus_session"].dump(),
                                 session_version)};
    }
    TALUS_TRY(
        twin::check_keys(written, {"talus_session", "name", "title", "saved_at", "scenarios", "overlays", "tiles"}));
    SessionFile file;
    TALUS_ASSIGN(file.name, needed_text(written, "name"));
    TALUS_ASSIGN(file.title, needed_text(written, "title"));
    const json list = written.value("scenarios", json());
    if (!list.is_array() || list.empty() || list.size() > Scenarios::max_count) {
        return Error{fmt::format("scenarios: must be a list of 1 to {}", Scenarios::max_count)};
    }
    for (std::size_t k = 0; k < list.size(); ++k) {
        auto scenario = read_scenario(list[k]);
        if (!scenario) return Error{fmt::format("scenarios[{}]: {}", k, scenario.error().message)};
        const auto same = std::find_if(file.scenarios.begin(), file.scenarios.end(),
                                       [&](const SavedScenario& other) { return other.index == scenario->index; });
        if (same != file.scenarios.end()) return Error{fmt::format("scenarios[{}]: this name is there twice", k)};
        const twin::Journal& first = file.scenarios.empty() ? scenario->journal : file.scenarios[0].journal;
        if (scenario->journal.scene_file != first.scene_file || scenario->journal.overrides != first.overrides) {
            return Error{fmt::format("scenarios[{}]: is of another scene than the first", k)};
        }
        file.scenarios.push_back(std::move(*scenario));
    }
    if (file.scenarios[0].index != 0) return Error{"scenarios[0]: the first scenario must be A"};
    // Sessions did not always have them.
    TALUS_ASSIGN(file.overlays, read_saved_overlays(written.value("overlays", json())));
    TALUS_ASSIGN(file.tiles, read_saved_tiles(written.value("tiles", json())));
    return Result<SessionFile>(std::move(file));
}

Result<std::vector<OpeningScenario>> replay_session(const SessionFile& file,
                                                    const std::shared_ptr<const scene::Scene>& scene,
                                                    const std::function<bool(const std::string&, double)>& say,
                                                    std::vector<std::string>& notes) {
    notes = twin::changed_inputs(file.scenarios[0].journal, *scene);
    run::Threads threads(scene->spec.solver.thread_count);
    std::vector<OpeningScenario> made;
    for (const SavedScenario& saved : file.scenarios) {
        const std::string what = std::string("Scenario ") + Scenarios::name_of(saved.index);
        const auto steps = static_cast<double>(std::max<std::uint64_t>(1, saved.journal.steps));
        bool stopped = !say(what, 0);
        twin::ScenarioOptions options;
        options.overrides = saved.journal.overrides;
        auto replayed = threads.execute([&] {
            return twin::replay(
                saved.journal, scene,
                [&](std::uint64_t step) {
                    stopped = stopped || (step % 16 == 0 && !say(what, static_cast<double>(step) / steps));
                    return !stopped;
                },
                options);
        });
        if (stopped) return Error{"cancelled"};
        if (!replayed) return Error{fmt::format("{}: {}", what, replayed.error().message)};
        if (replayed->hash != saved.journal.hash) {
            notes.push_back(fmt::format("{}: the result differs from the saved one (hash {} after step {}, was {})",
                                        what, replayed->hash, replayed->steps, saved.journal.hash));
        }
        made.push_back({saved.index, saved.title, std::move(replayed->scenario)});
    }
    return made;
}

}  // namespace talus::serve
