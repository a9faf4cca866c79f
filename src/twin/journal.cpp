#include "twin/journal.hpp"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "geo/json_text.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/scenario_parts.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr int version = 1;

/// Reads keys of known kinds; the first mismatch is kept as the error.
class JournalReader {
  public:
    /// Refuses any other key.
    void keys(const json& object, const char* of, std::initializer_list<std::string_view> known,
              const std::vector<std::string>& also = {}) {
        const Status s = object.is_object() ? check_keys(object, also, known) : Status();
        if (!s) refuse(of + (": " + s.error().message));
    }
    const json& object(const json& parent, const char* key) {
        return take(parent, key, "an object", [](const json& v) { return v.is_object(); });
    }
    const json& list(const json& parent, const char* key) {
        return take(parent, key, "a list", [](const json& v) { return v.is_array(); });
    }
    std::string text(const json& parent, const char* key) {
        const json& v = take(parent, key, "a text", [](const json& value) { return value.is_string(); });
        return v.is_string() ? v.get<std::string>() : "";
    }
    std::uint64_t whole(const json& parent, const char* key) {
        const json& v = take(parent, key, "a whole number, 0 or more",
                             [](const json& value) { return value.is_number_unsigned(); });
        return v.is_number_unsigned() ? v.get<std::uint64_t>() : 0;
    }
    double number(const json& parent, const char* key) {
        const json& v = take(parent, key, "a number", [](const json& value) { return value.is_number(); });
        return v.is_number() ? v.get<double>() : 0;
    }
    [[nodiscard]] const Status& status() const { return status_; }
    void refuse(std::string message) {
        if (status_) status_ = Error{std::move(message)};
    }

  private:
    template <class Fits>
    const json& take(const json& parent, const char* key, const char* kind, const Fits& fits) {
        static const json nothing;
        const auto found = parent.is_object() ? parent.find(key) : parent.end();
        if (!parent.is_object() || found == parent.end()) {
            refuse(fmt::format("{}: missing; it must be {}", key, kind));
            return nothing;
        }
        if (!fits(*found)) {
            refuse(fmt::format("{} = {}: must be {}", key, shown(*found), kind));
            return nothing;
        }
        return *found;
    }

    Status status_;
};

}  // namespace

json write_journal(const Journal& journal) {
    json inputs = json::array(), actions = json::array();
    for (const scene::InputFile& input : journal.inputs) {
        inputs.push_back({{"role", input.role}, {"path", input.path}, {"fnv1a_64", input.hash}});
    }
    for (const JournalEntry& entry : journal.entries) {
        json written = {{"step", entry.step}, {"by", entry.by}, {"action", entry.action}};
        if (!entry.setup.is_null()) written["setup"] = entry.setup;
        actions.push_back(std::move(written));
    }
    json next = json::object();
    for_each_kind([&]<class Kind>(Kind) { next[Kind::name] = journal.next.*Kind::number; });
    return {{"talus_journal", version},
            {"scene", {{"file", journal.scene_file}, {"overrides", journal.overrides}, {"inputs", inputs}}},
            {"first_setup", journal.first_setup},
            {"next", next},
            {"actions", actions},
            {"last",
             {{"step", journal.steps},
              {"time_s", journal.time},
              {"hash", journal.hash},
              {"instruction_set", journal.instruction_set}}}};
}

Result<Journal> read_journal(const std::string& text) {
    TALUS_ASSIGN(const json file, geo::parse_json(text));
    JournalReader read;
    if (const std::uint64_t found = read.whole(file, "talus_journal"); read.status() && found != version) {
        return Error{fmt::format("talus_journal = {}: this program reads version {}", found, version)};
    }
    read.keys(file, "journal", {"talus_journal", "scene", "first_setup", "next", "actions", "last"});
    Journal journal;
    const json& scene = read.object(file, "scene");
    read.keys(scene, "scene", {"file", "overrides", "inputs"});
    journal.scene_file = read.text(scene, "file");
    for (const json& entry : read.list(scene, "overrides")) {
        if (entry.is_string()) {
            journal.overrides.push_back(entry);
        } else {
            read.refuse(fmt::format("overrides = {}: must be texts", shown(entry)));
        }
    }
    for (const json& input : read.list(scene, "inputs")) {
        read.keys(input, "scene.inputs", {"role", "path", "fnv1a_64"});
        journal.inputs.push_back({read.text(input, "role"), read.text(input, "path"), 0, read.text(input, "fnv1a_64")});
    }
    journal.first_setup = read.object(file, "first_setup");
    const json& next = read.object(file, "next");
    std::vector<std::string> names;
    for_each_kind([&]<class Kind>(Kind) {
        names.emplace_back(Kind::name);
        if (!Kind::in_every_file && !next.contains(Kind::name)) return;
        journal.next.*Kind::number = static_cast<int>(read.whole(next, Kind::name));
    });
    read.keys(next, "next", {}, names);
    std::uint64_t before = 0;
    for (const json& entry : read.list(file, "actions")) {
        read.keys(entry, "actions", {"step", "by", "action", "setup"});
        JournalEntry action{read.whole(entry, "step"), read.text(entry, "by"), read.object(entry, "action"), {}};
        if (entry.is_object() && entry.contains("setup")) action.setup = read.object(entry, "setup");
        if (action.step < before) {
            read.refuse(fmt::format("step = {}: comes after step {}; actions must be in order", action.step, before));
        }
        before = action.step;
        journal.entries.push_back(std::move(action));
    }
    const json& last = read.object(file, "last");
    read.keys(last, "last", {"step", "time_s", "hash", "instruction_set"});
    journal.steps = read.whole(last, "step");
    journal.time = read.number(last, "time_s");
    journal.hash = read.text(last, "hash");
    journal.instruction_set = read.text(last, "instruction_set");
    if (before > journal.steps) {
        read.refuse(fmt::format("last.step = {}: an action comes after it, at step {}", journal.steps, before));
    }
    TALUS_TRY(read.status());
    return journal;
}

Journal journal_of(const Scenario& scenario) {
    const Scenario::Parts& p = scenario.parts();
    std::string file = p.scene->file.string();
    if (!file.starts_with("built-in:")) file = std::filesystem::absolute(p.scene->file).lexically_normal().string();
    return {file,
            p.options.overrides,
            p.scene->inputs,
            p.first_setup,
            p.first_next,
            p.entries,
            scenario.step(),
            scenario.time(),
            to_hex(hash_state(p.run->state())),
            p.run->instruction_set()};
}

std::vector<std::string> changed_inputs(const Journal& journal, const scene::Scene& scene) {
    std::vector<std::string> sentences;
    for (const scene::InputFile& then : journal.inputs) {
        const auto now = std::find_if(scene.inputs.begin(), scene.inputs.end(),
                                      [&](const scene::InputFile& input) { return input.role == then.role; });
        if (now == scene.inputs.end()) {
            sentences.push_back(
                fmt::format("the session read {} ({}); the scene does not any more", then.role, then.path));
        } else if (now->hash != then.hash) {
            sentences.push_back(fmt::format("{} has changed since the session: {} has hash {} and had {}", then.role,
                                            now->path, now->hash, then.hash));
        }
    }
    return sentences;
}

Result<Replayed> replay(const Journal& journal, std::shared_ptr<const scene::Scene> scene,
                        const std::function<bool(std::uint64_t)>& on_step, std::optional<ScenarioOptions> options) {
    if (!options) options = ScenarioOptions{journal.overrides, 1e9, 0};
    TALUS_ASSIGN(auto opened, Scenario::open_at(journal, std::move(scene), std::move(*options)));
    Scenario& scenario = *opened;
    bool stopped = false;
    const auto go_to = [&](std::uint64_t step) -> Status {
        while (scenario.step() < step && !stopped) {
            if (scenario.phase() != run::RunPhase::ready) {
                return Error{
                    fmt::format("step = {}: the run ended at step {} ({})", step, scenario.step(), scenario.message())};
            }
            scenario.advance();
            stopped = on_step && !on_step(scenario.step());
        }
        return {};
    };
    for (std::size_t k = 0; k < journal.entries.size() && !stopped; ++k) {
        const JournalEntry& entry = journal.entries[k];
        if (Status s = go_to(entry.step); !s) return Error{fmt::format("actions[{}]: {}", k, s.error().message)};
        if (Status s = scenario.follow(entry); !s) return Error{fmt::format("actions[{}]: {}", k, s.error().message)};
    }
    if (Status s = go_to(journal.steps); !s) return Error{"last." + s.error().message};
    return Replayed{scenario.step(), scenario.time(), to_hex(hash_state(scenario.run().state())), std::move(opened)};
}

}  // namespace talus::twin
