#include "serve/start.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "messages/messages.hpp"
#include "scene/builtin.hpp"
#include "scene/bundle.hpp"
#include "serve/api.hpp"
#include "session/json_text.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::string_view builtin_prefix = "built-in:";

const char* name_of(KnownScene::Kind kind) {
    return kind == KnownScene::Kind::recent ? "recent" : kind == KnownScene::Kind::own ? "own" : "builtin";
}

messages::KnownScene message_of(const KnownScene& scene) {
    return {.id = scene.id,
            .title = scene.title,
            .kind = name_of(scene.kind),
            .file = messages::if_any(scene.file.string()),
            .opened_at = messages::if_any(scene.opened_at),
            .missing = scene.missing};
}

messages::SavedSession message_of(const SavedSession& saved) {
    return {.id = saved.id,
            .name = saved.name,
            .title = saved.title,
            .saved_at = saved.saved_at,
            .scenarios = saved.scenarios};
}

Response done(const std::string& sentence, const std::optional<std::string>& created = {}) {
    return json_response(200, messages::Done{.done = sentence, .created = created});
}

Response of(const Status& status, const std::string& sentence) {
    return status ? done(sentence) : error_response(404, status.error().message);
}

}  // namespace

Start::Start(StartSettings settings, ServerOptions options, Host host)
    : settings_(std::move(settings)),
      options_(std::move(options)),
      host_(std::move(host)),
      library_(settings_.folder),
      drafts_(std::make_unique<Drafts>(host_.executor, settings_.folder, settings_.uploads, options_.export_folder,
                                       settings_.reader)),
      jobs_(std::make_unique<Jobs>(host_.executor, settings_.folder / "jobs", settings_.program)) {}

Start::~Start() {
    close();
}

void Start::close() {
    if (std::exchange(closed_, true)) return;  // the host may be gone
    stop_ = true;
    opener_.close();
    if (made_) made_->close();
    made_ = nullptr;
    if (const OpenSessionPtr open = host_.open()) open->close();  // its loop may be handing over what is to be saved
    files_.close();
    drafts_.reset();
    job_forms_.reset();
    jobs_.reset();
}

void Start::describe(Role role, const Respond& respond) {
    const OpenSessionPtr open = host_.open();
    const std::lock_guard lock(mutex_);
    messages::StartPage page{.available = true,
                             .open = {},
                             .opening = {},
                             .error = messages::if_any(state_.error),
                             .count = state_.count,
                             .notes = state_.notes,
                             .program = "talus " TALUS_VERSION,
                             .role = role_name(role)};
    if (open) page.open = {.title = open->session.scene()->spec.scene.title};
    if (state_.busy) page.opening = {.what = state_.what, .share = state_.share};
    if (role < Role::controller) {  // paths and names of files are not for viewers
        respond(json_response(200, page));
        return;
    }
    files_.post([this, respond, page]() mutable {
        page.folder = library_.folder().string();
        const UploadLimits& limits = settings_.uploads;
        page.uploads = {.bytes = limits.bytes, .files = limits.files, .cells = limits.cells};
        auto& scenes = page.scenes.emplace();
        for (const KnownScene& scene : library_.scenes()) scenes.push_back(message_of(scene));
        auto& sessions = page.sessions.emplace();
        for (const SavedSession& saved : library_.sessions()) sessions.push_back(message_of(saved));
        page.jobs.emplace(jobs_->describe());
        respond(json_response(200, page));
    });
}

void Start::open(const Request& request, const Respond& respond) {
    const auto wanted = read_object(request.body, {"scene", "session", "ensemble", "replace"});
    if (!wanted) return respond(error_response(400, wanted.error().message));
    const std::string scene = text_at(*wanted, "scene"), session = text_at(*wanted, "session");
    const std::string ensemble = text_at(*wanted, "ensemble");
    if (scene.empty() + session.empty() + ensemble.empty() != 2) {
        return respond(error_response(400, "the body names a scene, a session or an ensemble, one of them, by its id"));
    }
    if (const OpenSessionPtr open = host_.open()) {
        if (wanted->value("replace", json()) != true) {
            return respond(error_response(409, "a session is open; say \"replace\": true to end it"));
        }
        const Person* who = open->session.people().whose(request.secret);
        if (const Status allowed = open->session.people().may_act(who ? who->id : ""); !allowed) {
            return respond(error_response(409, allowed.error().message));
        }
    }
    files_.post([this, scene, session, ensemble, respond] {
        auto found = find(scene, session, ensemble);
        if (!found) return respond(error_response(404, found.error().message));
        begin(std::move(*found), respond);
    });
}

Result<Start::Wanted> Start::find(const std::string& scene, const std::string& session,
                                  const std::string& ensemble) const {
    std::string wanted = scene;
    std::vector<fs::path> ensembles;
    if (!ensemble.empty()) {
        TALUS_ASSIGN(const auto finished, jobs_->ensemble(ensemble));
        wanted = finished.scene;
        ensembles = {finished.folder};
    }
    for (const KnownScene& known : library_.scenes()) {
        if (!wanted.empty() && known.id == wanted) return Wanted{known, {}, false, known.title, std::move(ensembles)};
    }
    if (!ensemble.empty()) return Error{"the scene of this ensemble is no longer in the list; open it once"};
    for (const SavedSession& saved : library_.sessions()) {
        if (!session.empty() && saved.id == session) return Wanted{{}, saved.file, false, saved.name};
    }
    return Error{"there is nothing of this id; reload the page"};
}

void Start::open_file(const fs::path& file) {
    Wanted wanted;
    wanted.what = file.filename().string();
    wanted.any_scene = true;
    if (file.extension() == ".json") {
        wanted.session = file;
    } else {
        wanted.scene = KnownScene{"", wanted.what, KnownScene::Kind::recent, fs::absolute(file), "", false};
    }
    begin(std::move(wanted), [](const Response&) {});
}

void Start::begin(Wanted wanted, const Respond& respond) {
    {
        const std::lock_guard lock(mutex_);
        if (state_.busy) {
            respond(error_response(409, fmt::format("{} is being opened; wait for it, or cancel it", state_.what)));
            return;
        }
        state_.busy = true;
        state_.what = wanted.what;
        state_.error.clear();
        state_.share = 0;
        stop_ = false;
    }
    respond(json_response(202, messages::Done{.done = "opening " + wanted.what, .created = {}}));
    opener_.post([this, wanted = std::move(wanted)] { work(wanted); });
}

bool Start::say(const std::string& what, double share) {
    const std::lock_guard lock(mutex_);
    state_.what = what;
    state_.share = share;
    return !stop_;
}

void Start::end(const std::string& error) {
    const std::lock_guard lock(mutex_);
    state_.busy = false;
    state_.error = error;
}

void Start::work(const Wanted& wanted) {
    try {
        auto loaded = load(wanted);
        if (!loaded) return end(loaded.error().message);
        auto made = OpenSession::open(host_.thread, host_.executor, loaded->scene, loaded->options,
                                      std::move(loaded->scenarios), std::move(loaded->overlays), loaded->tiles);
        if (!made) return end(made.error().message);
        if (stop_) {
            OpenSession::retire(host_.thread, std::move(*made));
            return end("cancelled");
        }
        // A list of recent scenes that cannot be written is no reason not to open one.
        if (!loaded->options.calibration.own_files) {
            (void)library_.remember(loaded->scene->file, loaded->scene->spec.scene.title).ok();
        }
        {
            const std::lock_guard lock(mutex_);
            made_ = *made;
            state_.notes = std::move(loaded->notes);
        }
        host_.thread.post([this] { put_in_place(); });
    } catch (const std::exception& error) {
        end(fmt::format("{} cannot be opened: {}", wanted.what, error.what()));
    }
}

void Start::put_in_place() {
    const OpenSessionPtr former = host_.open();
    {
        const std::lock_guard lock(mutex_);
        host_.take(std::exchange(made_, nullptr));
        state_.busy = false;
        ++state_.count;
    }
    if (!former) return;
    former->session.dismiss_all();
    opener_.post([thread = host_.thread, former] { OpenSession::retire(thread, former); });
}

Result<Start::Loaded> Start::load(const Wanted& wanted) {
    if (wanted.scene) {
        TALUS_ASSIGN(auto loaded, load_scene(*wanted.scene, {}));
        loaded.options.ensembles = wanted.ensembles;
        return Result<Loaded>(std::move(loaded));
    }
    TALUS_ASSIGN(const auto text, read_whole(wanted.session, Library::longest_session));
    auto file = read_session(text);
    if (!file) return Error{fmt::format("{}: {}", wanted.session.filename().string(), file.error().message)};
    TALUS_ASSIGN(const auto known, scene_of(*file, wanted.any_scene));
    TALUS_ASSIGN(auto loaded, load_scene(known, file->scenarios[0].journal.overrides));
    TALUS_ASSIGN(loaded.scenarios,
                 replay_session(
                     *file, loaded.scene, [this](const std::string& what, double share) { return say(what, share); },
                     loaded.notes));
    loaded.overlays = std::move(file->overlays);
    loaded.tiles = std::move(file->tiles);
    return Result<Loaded>(std::move(loaded));
}

/// Only a scene that this page could open anyway: a session file may come from a browser.
Result<KnownScene> Start::scene_of(const SessionFile& file, bool any) const {
    const std::string& wanted = file.scenarios[0].journal.scene_file;
    const bool builtin = wanted.starts_with(builtin_prefix);
    for (const KnownScene& known : library_.scenes()) {
        if (builtin ? known.file.empty() : known.file == wanted) return known;
    }
    if (any) return KnownScene{"", file.title, KnownScene::Kind::recent, wanted, "", false};
    return Error{fmt::format("the scene of this session, {}, is not known here; open it once with: talus start {}",
                             wanted, wanted)};
}

Result<Start::Loaded> Start::load_scene(const KnownScene& known, const std::vector<std::string>& overrides) {
    Loaded loaded;
    loaded.options = options_;
    ServerOptions& options = loaded.options;
    options.export_folder = options_.export_folder / fmt::format("session_{}", ++folders_);
    std::error_code error;
    fs::create_directories(options.export_folder, error);
    if (error) return Error{fmt::format("{}: {}", options.export_folder.string(), error.message())};
    const bool builtin = known.file.empty();
    fs::path file = known.file;
    const fs::path unpacked = options.export_folder / "scene";
    if (builtin) {
        TALUS_ASSIGN(file, scene::unpack_builtin_scene(unpacked));
    }
    TALUS_TRY(scene::check_saved_overrides(file, overrides));
    TALUS_ASSIGN(auto scene, scene::load_scene(file, overrides));
    leave_out_zoom(scene, "the live twin");
    if (builtin)
        scene::name_unpacked_files(scene, unpacked, fmt::format("{}{}", builtin_prefix, scene::builtin_scene_name));
    options.scenario.overrides = overrides;
    options.calibration.source = {file, overrides};
    options.calibration.own_files = builtin;
    options.calibration.scene_name = builtin ? std::string("built-in") : fs::absolute(file).lexically_normal().string();
    options.calibration.folder = options.export_folder;
    loaded.scene = std::make_shared<const scene::Scene>(std::move(scene));
    return Result<Loaded>(std::move(loaded));
}

void Start::cancel(const Respond& respond) {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    respond(state_.busy ? done("cancelled: " + state_.what) : error_response(409, "nothing is being opened"));
}

void Start::forget(const std::string& id, const Respond& respond) {
    files_.post([this, id, respond] { respond(of(library_.forget(id), "taken out of the recent scenes")); });
}

/// A file of a session may be long: it is read beside the server's thread.
void Start::save(const Request& request, const Respond& respond) {
    files_.post([this, body = request.body, respond] { save_wanted(body, respond); });
}

void Start::save_wanted(const std::string& body, const Respond& respond) {
    auto wanted = read_object(body, {"name", "file"}, Library::most_session_values);
    if (!wanted) return respond(error_response(400, wanted.error().message));
    const std::string name = tidy_name(text_at(*wanted, "name"), 60);
    if (file_name_of(name).empty()) {
        return respond(error_response(400, "a session needs a name with letters or digits"));
    }
    if (!wanted->contains("file")) {
        return host_.thread.post([this, name, respond] { save_open(name, respond); });
    }
    json file = std::move((*wanted)["file"]);
    if (const auto read = read_session(file.dump()); !read) return respond(error_response(400, read.error().message));
    file["name"] = name;
    keep(name, to_text(file), respond);
}

void Start::save_open(const std::string& name, const Respond& respond) {
    const OpenSessionPtr open = host_.open();
    if (!open) return respond(error_response(409, "no scene is open; there is nothing to save"));
    open->session.loop().post([this, name, respond, title = open->session.scene()->spec.scene.title,
                               laid = open->overlays.saved()](Scenarios& all) {
        files_.post([this, name, respond, text = to_text(write_session(all, name, title, laid))] {
            keep(name, text, respond);
        });
    });
}

void Start::keep(const std::string& name, const std::string& session, const Respond& respond) const {
    const auto saved = library_.save_session(name, session + "\n");
    respond(saved ? done(fmt::format("saved as \"{}\"", name), *saved) : error_response(500, saved.error().message));
}

void Start::remove_saved(const std::string& id, const Respond& respond) {
    files_.post([this, id, respond] { respond(of(library_.remove_session(id), "removed")); });
}

void Start::remove_scene(const std::string& id, const Respond& respond) {
    files_.post([this, id, respond] { respond(of(library_.remove_scene(id), "deleted")); });
}

void Start::download(const std::string& id, const Respond& respond) {
    files_.post([this, id, respond] {
        for (const KnownScene& known : library_.scenes()) {
            if (known.id != id) continue;
            return drafts_->pack(known.file, known.file.empty(), known.title, respond);
        }
        respond(error_response(404, "there is nothing of this id; reload the page"));
    });
}

void Start::with_scene(const std::string& id, const Respond& respond, std::function<void(const KnownScene&)> ask) {
    files_.post([this, id, respond, ask = std::move(ask)] {
        for (const KnownScene& known : library_.scenes()) {
            if (known.id == id) return ask(known);
        }
        respond(error_response(404, "there is nothing of this id; reload the page"));
    });
}

void Start::add_job(const Request& request, const Respond& respond) {
    const auto body = parse_json(request.body);
    const auto wanted = body ? read_wanted_job(*body) : Result<WantedJob>(body.error());
    if (!wanted) return respond(error_response(400, wanted.error().message));
    const auto add = [this, wanted = *wanted, respond](const std::optional<KnownScene>& scene) {
        const auto added = jobs_->add(wanted, scene);
        respond(added ? json_response(202, messages::Done{.done = "the job is in the queue", .created = *added})
                      : error_response(409, added.error().message));
    };
    if (wanted->kind == JobKind::validation) return add({});
    with_scene(wanted->scene, respond, [this, wanted = *wanted, respond, add](const KnownScene& scene) {
        job_forms_->check(wanted, scene, respond, [add, scene] { add(scene); });
    });
}

void Start::quit(const Respond& respond) {
    Response answer = done("talus has ended");
    // The end of the server would be the end of an answer on its way.
    answer.written = settings_.on_quit;
    respond(std::move(answer));
}

}  // namespace talus::serve
