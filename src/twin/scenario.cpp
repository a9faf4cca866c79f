#include "twin/scenario.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "products/fault_files.hpp"
#include "products/text_file.hpp"
#include "scene/particle_spacing.hpp"
#include "twin/action.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/scenario_parts.hpp"
#include "twin/setup_file.hpp"
#include "twin/trigger.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t max_undo = 200;

/// A setup whose releases wait again, as they do at time 0.
Setup held_again(Setup setup) {
    for (ReleaseSetup& release : setup.releases) release.triggered = false;
    return setup;
}

/// Changes of setups that can be undone or redone at time 0: all releases wait, so no start is among them.
template <class Pasts>
Pasts held_again(Pasts pasts) {
    std::erase_if(pasts, [](const auto& past) { return past.by_trigger; });
    for (auto& past : pasts) past.setup = held_again(std::move(past.setup));
    return pasts;
}

/// Writes a fault and the journal that leads to it into a new folder FOLDER/fault_N, and returns its path.
Result<std::filesystem::path> keep_fault(const run::FaultRecord& record, const json& journal,
                                         const std::filesystem::path& folder) {
    std::error_code error;
    int number = 1;
    while (std::filesystem::exists(folder / fmt::format("fault_{}", number), error)) ++number;
    auto kept = folder / fmt::format("fault_{}", number);
    TALUS_TRY(products::write_fault(record, kept));
    TALUS_TRY(products::write_text_file(kept / "journal.json", journal.dump(1) + "\n"));
    return kept;
}

}  // namespace

Result<std::unique_ptr<LiveRun>> Scenario::Parts::run_of(const Setup& setup, const sim::Progress& progress) const {
    auto started = LiveRun::start(*scene, setup, particle_spacing, options, progress);
    if (!started) return Error{scene->file.string() + ": " + started.error().message};
    return started;
}

void Scenario::Parts::take(std::unique_ptr<LiveRun> begun) {
    run = std::move(begun);
    first_setup = write_setup(setup());
    first_next = next;
    entries.clear();
    changes.clear();
    ++revision;
}

Status Scenario::Parts::start(const Setup& setup, const sim::Progress& progress) {
    TALUS_ASSIGN(auto begun, run_of(setup, progress));
    take(std::move(begun));
    return {};
}

Status Scenario::Parts::prepare(const Setup& next_setup, Prepared& prepared, const sim::Progress& progress) const {
    TALUS_ASSIGN(prepared.change, run->prepare(next_setup, progress));
    if (prepared.change) return {};
    TALUS_ASSIGN(prepared.anew, LiveRun::start(*scene, next_setup, particle_spacing, options, progress));
    return prepared.anew->bring_to(next_setup);  // releases that were triggered
}

void Scenario::Parts::carry_out(Prepared& prepared) {
    if (prepared.anew) {
        run = std::move(prepared.anew);
    } else {
        run->carry_out(*prepared.change);
    }
}

Scenario::Scenario(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Scenario::~Scenario() = default;

Scenario::Parts::Parts(std::shared_ptr<const scene::Scene> its_scene, ScenarioOptions its_options)
    : scene(std::move(its_scene)), options(std::move(its_options)) {
    particle_spacing = scene::particle_spacing(*scene);
}

Scenario::Opened Scenario::open(std::shared_ptr<const scene::Scene> scene, ScenarioOptions options,
                                const sim::Progress& progress) {
    auto parts = std::make_unique<Parts>(std::move(scene), std::move(options));
    const Setup setup = setup_of(*parts->scene, parts->next);
    TALUS_TRY(parts->start(setup, progress));
    return std::unique_ptr<Scenario>(new Scenario(std::move(parts)));
}

Scenario::Opened Scenario::open_at(const Journal& journal, std::shared_ptr<const scene::Scene> scene,
                                   ScenarioOptions options) {
    auto setup = read_setup(journal.first_setup, *scene);
    if (!setup) return Error{"first_setup: " + setup.error().message};
    auto parts = std::make_unique<Parts>(std::move(scene), std::move(options));
    parts->next = journal.next;
    // Former journals have no numbers for these: those of the scene have the first ones.
    NextNumbers of_scene;
    static_cast<void>(setup_of(*parts->scene, of_scene));
    for_each_kind([&]<class Kind>(Kind) {
        if (Kind::in_every_file) return;
        int& number = parts->next.*Kind::number;
        number = std::max(number, of_scene.*Kind::number);
    });
    TALUS_TRY(parts->start(*setup));
    return std::unique_ptr<Scenario>(new Scenario(std::move(parts)));
}

std::unique_ptr<Scenario> Scenario::fork() const {
    return std::unique_ptr<Scenario>(new Scenario(std::make_unique<Parts>(*parts_)));
}

Scenario::Opening Scenario::copying() const {
    auto parts = std::make_shared<std::unique_ptr<Parts>>(std::make_unique<Parts>(parts_->scene, parts_->options));
    (*parts)->next = parts_->next;
    (*parts)->undo = held_again(parts_->undo);
    (*parts)->redo = held_again(parts_->redo);
    return [parts, setup = held_again(parts_->setup())](const sim::Progress& progress) -> Opened {
        TALUS_TRY((*parts)->start(setup, progress));
        return std::unique_ptr<Scenario>(new Scenario(std::move(*parts)));
    };
}

Scenario::Opening Scenario::opening() const {
    return [scene = parts_->scene, options = parts_->options, now = parts_->setup(),
            numbers = parts_->next](const sim::Progress& progress) -> Opened {
        auto parts = std::make_unique<Parts>(scene, options);
        Setup setup = setup_of(*scene, parts->next);
        take_tables(setup, parts->next, now, numbers);
        TALUS_TRY(parts->start(setup, progress));
        return std::unique_ptr<Scenario>(new Scenario(std::move(parts)));
    };
}

void Scenario::advance() {
    Parts& p = *parts_;
    const bool ready = phase() == run::RunPhase::ready;
    p.run->advance();
    if (!ready || phase() != run::RunPhase::fault) return;
    run::FaultRecord record = *p.run->fault();
    const json last = p.entries.empty() ? json() : p.entries.back().action;
    record.content["last_action"] = last;
    p.fault_note = record.sentence;
    if (!last.is_null()) p.fault_note += fmt::format("; the last action was {}", last["action"].get<std::string>());
    if (p.options.fault_folder.empty()) return;
    const auto kept = keep_fault(record, write_journal(journal_of(*this)), p.options.fault_folder);
    p.fault_note += kept ? fmt::format("; journal and last good state are in {}", kept->string())
                         : "; nothing is kept of it: " + kept.error().message;
}

void Scenario::Parts::note_change(const json& action, const std::string& by, const std::string& sentence) {
    const std::uint64_t step = run->summary().step;
    if (step == 0) return;
    const bool undoes = action["action"] == "undo", redoes = action["action"] == "redo";
    const bool reverses = !changes.empty() && changes.back().step == step && (changes.back().undoes ? redoes : undoes);
    if (reverses) {
        changes.pop_back();
    } else {
        changes.push_back({step, run->summary().time, by, sentence, undoes});
    }
}

Result<std::shared_ptr<Scenario::Prepared>> Scenario::prepare(const json& action, const std::string& by,
                                                              const sim::Progress& progress) const {
    TALUS_ASSIGN(const std::string name, action_name(action));
    const Parts& p = *parts_;
    auto prepared = std::make_shared<Prepared>();
    prepared->action = action;
    prepared->by = by;
    prepared->next = p.next;
    if (name == "undo" || name == "redo" || name == "restart") {
        TALUS_TRY(check_keys(action, {"action"}));
    }
    if (name == "restart") {
        TALUS_ASSIGN(prepared->anew, p.run_of(held_again(p.setup()), progress));
        prepared->done = {"started again from time 0", ""};
        return prepared;
    }
    if (name == "undo" || name == "redo") {
        const std::vector<Parts::Past>& pasts = name == "undo" ? p.undo : p.redo;
        if (pasts.empty()) return Error{fmt::format("action = \"{}\": there is nothing to {}", name, name)};
        TALUS_TRY(p.prepare(pasts.back().setup, *prepared, progress));
        prepared->done = {fmt::format("{}: {}", name, pasts.back().sentence), ""};
        return prepared;
    }
    const ActionContext context{*p.scene, p.particle_spacing, p.run->model().viscosity,
                                [&](const std::string& id) { return p.run->has_begun(id); }, p.run->summary().step > 0};
    if (name == "gauge") {
        TALUS_ASSIGN(prepared->gauge, p.prepare_gauge(action, context));
        prepared->done = {prepared->gauge->sentence, ""};
        return prepared;
    }
    TALUS_ASSIGN(Edit made, name == "trigger" ? read_trigger(action, p.setup(), context)
                                              : read_action(action, p.setup(), prepared->next, context));
    TALUS_TRY(p.prepare(made.setup, *prepared, progress));
    prepared->by_trigger = name == "trigger_release";
    prepared->done = {made.sentence, made.created};
    return prepared;
}

Result<GaugeReading> Scenario::Parts::prepare_gauge(const json& action, const ActionContext& context) const {
    if (run->phase() != run::RunPhase::ready) return Error{"the run is over: " + run->message()};
    double last = -1;
    for (const JournalEntry& entry : entries) {
        if (entry.action["action"] == "trigger") last = std::max(last, 0.0);
        if (entry.action["action"] == "gauge") last = entry.action["time_s"];
    }
    return read_gauge(action, setup(), run->begun_with(), context, run->summary().time, last);
}

void Scenario::Parts::follow_gauge(const GaugeReading& reading) {
    const auto before = find_id(setup().inflows, reading.inflow_id)->body;
    run->follow_gauge(reading.inflow_id, reading.body);
    for (std::vector<Past>* pasts : {&undo, &redo}) {
        for (Past& past : *pasts) {
            InflowSetup* inflow = find_id(past.setup.inflows, reading.inflow_id);
            if (inflow == nullptr || inflow->body != before) continue;
            inflow->body = reading.body;
            inflow->as_in_scene = false;
        }
    }
}

/// What can be undone and redone after a change.
void Scenario::Parts::keep_past(Prepared& prepared) {
    const json& name = prepared.action["action"];
    if (name == "undo" || name == "redo") {
        std::vector<Past>& from = name == "undo" ? undo : redo;
        std::vector<Past>& to = name == "undo" ? redo : undo;
        Past past = std::move(from.back());
        from.pop_back();
        to.push_back({setup(), past.sentence, past.by_trigger});
        return;
    }
    undo.push_back({setup(), prepared.done.sentence, prepared.by_trigger});
    if (undo.size() > max_undo) undo.erase(undo.begin());
    redo.clear();
}

Done Scenario::commit(Prepared& prepared) {
    Parts& p = *parts_;
    const json& name = prepared.action["action"];
    if (name == "restart") {
        p.take(std::move(prepared.anew));
        p.undo = held_again(std::move(p.undo));
        p.redo = held_again(std::move(p.redo));
        return prepared.done;
    }
    JournalEntry entry{step(), prepared.by, prepared.action, nullptr};
    if (prepared.gauge) {
        p.follow_gauge(*prepared.gauge);
        p.entries.push_back(std::move(entry));
        ++p.revision;
        return prepared.done;
    }
    if (name == "trigger") {
        p.undo.clear();
        p.redo.clear();
    } else {
        p.keep_past(prepared);
    }
    const Setup before = p.setup();
    p.carry_out(prepared);
    p.next = prepared.next;
    if (name == "undo" || name == "redo") entry.setup = write_setup(p.setup());
    p.entries.push_back(std::move(entry));
    if (!move_alike(before, p.setup())) p.note_change(prepared.action, prepared.by, prepared.done.sentence);
    ++p.revision;
    return prepared.done;
}

Result<Done> Scenario::apply(const json& action, const std::string& by) {
    TALUS_ASSIGN(const auto prepared, prepare(action, by));
    return commit(*prepared);
}

Status Scenario::follow(const JournalEntry& entry) {
    if (entry.setup.is_null()) {
        TALUS_TRY(apply(entry.action, entry.by));
        return {};
    }
    TALUS_ASSIGN(auto setup, read_setup(entry.setup, *parts_->scene));
    Prepared prepared;
    TALUS_TRY(parts_->prepare(setup, prepared, {}));
    parts_->carry_out(prepared);
    parts_->entries.push_back(entry);
    ++parts_->revision;
    return {};
}

run::RunPhase Scenario::phase() const {
    return parts_->run->phase();
}
std::string Scenario::message() const {
    return parts_->run->message() + (phase() == run::RunPhase::fault ? parts_->fault_note : "");
}
double Scenario::time() const {
    return parts_->run->summary().time;
}
std::uint64_t Scenario::step() const {
    return parts_->run->summary().step;
}
const scene::Scene& Scenario::scene() const {
    return *parts_->scene;
}
const LiveRun& Scenario::run() const {
    return *parts_->run;
}

}  // namespace talus::twin
