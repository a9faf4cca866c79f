#include "serve/drafts.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "messages/messages.hpp"
#include "scene/builtin.hpp"
#include "scene/bundle.hpp"
#include "serve/access.hpp"
#include "serve/library.hpp"
#include "session/json_text.hpp"
#include "session/thinned.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr double relief_cells = 1e6;
constexpr std::size_t longest_title = 100, most_corners = 1000;
constexpr std::uintmax_t largest_archive = std::uintmax_t{1} << 30;

Response problem(const std::string& sentence) {
    return error_response(400, sentence);
}

bool known_role(const std::string& role) {
    return std::find(Draft::roles.begin(), Draft::roles.end(), role) != Draft::roles.end();
}

params::Range any_number() {
    return {-1e12, 1e12, true, true};
}

Result<geo::Mending> read_mending(const Request& request) {
    TALUS_ASSIGN(const json body, read_object(request.body, {"epsg", "local", "metric", "metres_per_unit", "nodata"}));
    geo::Mending mending;
    TALUS_ASSIGN(const auto epsg, twin::read_number(body, "epsg", {1024, 999999, true, true}, ""));
    if (epsg && *epsg != static_cast<int>(*epsg)) return Error{fmt::format("epsg = {}; it is a whole number", *epsg)};
    mending.epsg = static_cast<int>(epsg.value_or(0));
    mending.local = body.value("local", json(false)) == true;
    if (mending.local && mending.epsg != 0) {
        return Error{"epsg and local are given; coordinates are of a reference system, or local"};
    }
    mending.metric = body.value("metric", json(false)) == true;
    TALUS_ASSIGN(mending.metres_per_unit, twin::read_number(body, "metres_per_unit", {1e-4, 1e4, true, true}, "m"));
    TALUS_ASSIGN(mending.nodata, twin::read_number(body, "nodata", {-1e39, 1e39, true, true}, ""));
    return mending;
}

Result<std::vector<PlanPoint>> read_scar(const json& body) {
    std::vector<PlanPoint> scar;
    const auto found = body.find("scar");
    if (found == body.end() || found->is_null()) return scar;
    if (!found->is_array() || found->size() < 3 || found->size() > most_corners) {
        return Error{fmt::format("scar: is a list of 3 to {} places", most_corners)};
    }
    for (const json& place : *found) {
        const bool pair = place.is_array() && place.size() == 2 && place[0].is_number() && place[1].is_number();
        if (!pair || !any_number().contains(place[0].get<double>()) || !any_number().contains(place[1].get<double>())) {
            return Error{"scar: a place is [east, north], m"};
        }
        scar.push_back({place[0].get<double>(), place[1].get<double>()});
    }
    return Result<std::vector<PlanPoint>>(std::move(scar));
}

Result<Draft::Wanted> read_wanted(const json& body) {
    Draft::Wanted wanted;
    TALUS_ASSIGN(const auto title, twin::read_text(body, "title", 4 * longest_title));
    wanted.title = tidy_name(title.value_or(""), longest_title);
    const auto& range_of = [](const char* key) { return params::parameter_of("release", key).range; };
    TALUS_ASSIGN(wanted.thickness, twin::read_number(body, "thickness_m", range_of("thickness_m"), "m"));
    TALUS_ASSIGN(wanted.volume, twin::read_number(body, "volume_m3", range_of("volume_m3"), "m3"));
    if (wanted.thickness && wanted.volume) return Error{"thickness_m and volume_m3: give one of them"};
    TALUS_ASSIGN(wanted.scar, read_scar(body));
    return Result<Draft::Wanted>(std::move(wanted));
}

/// Whether a program of this number lives; its draft is its own.
bool lives(const std::string& number) {
    const int process = std::atoi(number.c_str());
    return process > 0 && (kill(process, 0) == 0 || errno == EPERM);
}

}  // namespace

/// A file on its way.
class Drafts::Taking : public Intake {
  public:
    Taking(Drafts& drafts, const Request& request)
        : drafts_(drafts), id_(request.parameters.at("id")), role_(request.parameters.at("role")) {
        if (const auto name = request.query.find("name"); name != request.query.end()) {
            name_ = tidy_name(name->second, 100);
        }
    }
    ~Taking() override {
        out_.close();
        std::error_code ignored;
        if (!part_.empty()) fs::remove(part_, ignored);
    }
    Taking(const Taking&) = delete;
    Taking& operator=(const Taking&) = delete;

    void take(std::string piece, std::function<void(std::optional<Response>)> then) override {
        // The connection holds this object until it is told.
        drafts_.lane_.post([this, piece = std::move(piece), then = std::move(then)] { then(write(piece)); });
    }
    void finish(const Respond& respond) override {
        drafts_.lane_.post([this, respond, stop = drafts_.begin_reading(role_)] {
            out_.close();
            Draft* draft = drafts_.find(id_, respond);
            if (draft == nullptr) return;
            geo::ForeignReader reader = drafts_.reader_;
            reader.shall_end = [stop] { return stop->load(); };
            if (const Status taken = draft->take(role_, name_, part_, reader); !taken) {
                return respond(problem(taken.error().message));
            }
            respond(json_response(200, draft->describe()));
        });
    }

  private:
    std::optional<Response> write(const std::string& piece) {
        std::optional<Response> refused;
        const Draft* draft = drafts_.find(id_, [&](Response response) { refused = std::move(response); });
        if (draft == nullptr) return refused;
        if (part_.empty()) {
            if (!known_role(role_)) {
                return error_response(404, "a file is terrain, release, buildings, orthophoto or bundle");
            }
            if (name_.empty()) return problem("name: the file's name is missing");
            part_ = draft->folder() / fmt::format("upload-{}.part", ++drafts_.uploads_);
            out_.open(part_, std::ios::binary);
        }
        if (piece.size() > draft->bytes_left()) {
            return error_response(413, fmt::format("{}: with it the files of this scene are longer than {:.4g} MB",
                                                   name_, static_cast<double>(drafts_.limits_.bytes) / 1e6));
        }
        out_.write(piece.data(), static_cast<std::streamsize>(piece.size()));
        out_.flush();  // so that it counts
        if (!out_) return error_response(507, name_ + ": cannot be kept; is the disk full?");
        return {};
    }

    Drafts& drafts_;
    const std::string id_, role_;
    std::string name_;
    fs::path part_;
    std::ofstream out_;
};

Drafts::Drafts(Executor& executor, fs::path library, UploadLimits limits, fs::path temporary, geo::ForeignReader reader)
    : library_(std::move(library)),
      temporary_(std::move(temporary)),
      limits_(limits),
      reader_(std::move(reader)),
      lane_(executor, "drafts") {
    lane_.post([this] { remove_leftovers(); });
}

Drafts::Stop Drafts::begin_reading(const std::string& role) {
    stop_reading(role);  // of the one that this one replaces
    auto stop = std::make_shared<std::atomic<bool>>(false);
    const std::lock_guard lock(mutex_);
    std::erase_if(readings_, [](const auto& reading) { return reading.second.expired(); });
    readings_.emplace_back(role, stop);
    return stop;
}

void Drafts::stop_reading(const std::string& role) {
    const std::lock_guard lock(mutex_);
    for (const auto& [of, reading] : readings_) {
        const Stop stop = role.empty() || of == role ? reading.lock() : nullptr;
        if (stop) *stop = true;
    }
}

Drafts::~Drafts() {
    stop_reading();
    lane_.close();
}

void Drafts::remove_leftovers() const {
    std::error_code error;
    for (fs::directory_iterator it(library_ / "drafts", error), end; !error && it != end; it.increment(error)) {
        const std::string name = it->path().filename().string();
        std::error_code ignored;
        if (!lives(name.substr(0, name.find('-')))) fs::remove_all(it->path(), ignored);
    }
}

Draft* Drafts::find(const std::string& id, const Respond& respond) {
    if (draft_ && id == id_) return draft_.get();
    respond(error_response(404, "this new scene is no longer there; begin it again"));
    return nullptr;
}

void Drafts::begin(const Respond& respond) {
    stop_reading();
    lane_.post([this, respond] {
        draft_.reset();
        auto id = random_token();
        if (!id) return respond(error_response(500, id.error().message));
        auto made = Draft::make(library_ / "drafts" / fmt::format("{}-{}", getpid(), *id), limits_);
        if (!made) return respond(error_response(500, made.error().message));
        draft_ = std::make_unique<Draft>(std::move(*made));
        id_ = std::move(*id);
        respond(json_response(200, messages::Done{.done = "a new scene is begun", .created = id_}));
    });
}

void Drafts::describe(const std::string& id, const Respond& respond) {
    lane_.post([this, id, respond] {
        if (const Draft* draft = find(id, respond)) respond(json_response(200, draft->describe()));
    });
}

void Drafts::discard(const std::string& id, const Respond& respond) {
    stop_reading();
    lane_.post([this, id, respond] {
        if (find(id, respond) == nullptr) return;
        draft_.reset();
        respond(json_response(200, messages::Done{.done = "discarded", .created = {}}));
    });
}

std::shared_ptr<Intake> Drafts::intake(const Request& request) {
    return std::make_shared<Taking>(*this, request);
}

void Drafts::remove(const std::string& id, const std::string& role, const Respond& respond) {
    stop_reading(role);
    lane_.post([this, id, role, respond] {
        Draft* draft = find(id, respond);
        if (draft == nullptr) return;
        draft->remove(role);
        respond(json_response(200, draft->describe()));
    });
}

void Drafts::mend(const Request& request, const Respond& respond) {
    const auto mending = read_mending(request);
    if (!mending) return respond(problem(mending.error().message));
    lane_.post([this, id = request.parameters.at("id"), mending = *mending, respond] {
        Draft* draft = find(id, respond);
        if (draft == nullptr) return;
        const Status done = draft->mend(mending);
        respond(done ? json_response(200, draft->describe()) : problem(done.error().message));
    });
}

void Drafts::relief(const std::string& id, const Respond& respond) {
    lane_.post([this, id, respond] {
        const Draft* draft = find(id, respond);
        if (draft == nullptr) return;
        const Grid<float>* terrain = draft->terrain();
        if (terrain == nullptr) return respond(error_response(409, "there is no terrain yet, or it cannot be one"));
        Response response;
        response.type = "application/octet-stream";
        response.body = session::terrain_message(*terrain, session::thinning(terrain->geometry, relief_cells));
        respond(response);
    });
}

void Drafts::make(const Request& request, const Respond& respond) {
    const auto body = read_object(request.body, {"title", "thickness_m", "volume_m3", "scar", "check"});
    if (!body) return respond(problem(body.error().message));
    auto wanted = read_wanted(*body);
    if (!wanted) return respond(problem(wanted.error().message));
    const bool check = body->value("check", json(false)) == true;
    lane_.post([this, id = request.parameters.at("id"), check, wanted = std::move(*wanted), respond] {
        Draft* draft = find(id, respond);
        if (draft == nullptr) return;
        if (check) {
            const auto found = draft->check(wanted);
            if (!found) return respond(problem(found.error().message));
            return respond(
                json_response(200, messages::Checked{.summary = found->summary, .notes = found->notes, .created = {}}));
        }
        const auto scene = draft->finish(wanted, Library(library_).scenes_folder());
        if (!scene) return respond(problem(scene.error().message));
        draft_.reset();
        respond(json_response(200, messages::Checked{.summary = "", .notes = {}, .created = Library::id_of(*scene)}));
    });
}

void Drafts::pack(const fs::path& scene, bool builtin, const std::string& name, const Respond& respond) {
    lane_.post([this, scene, builtin, name, respond] {
        const fs::path archive = temporary_ / "scene.zip", unpacked = temporary_ / "packed";
        auto bytes = [&]() -> Result<std::string> {
            fs::path file = scene;
            if (builtin) {
                TALUS_ASSIGN(file, scene::unpack_builtin_scene(unpacked));
            }
            TALUS_TRY(scene::write_bundle(file, archive));
            return read_whole(archive, largest_archive);
        }();
        std::error_code ignored;
        fs::remove(archive, ignored);
        fs::remove_all(unpacked, ignored);
        if (!bytes) return respond(error_response(409, bytes.error().message));
        Response response;
        response.type = "application/zip";
        response.body = std::make_shared<const std::string>(std::move(*bytes));
        const std::string plain = file_name_of(name);
        response.file_name = (plain.empty() ? "scene" : plain) + ".zip";
        respond(response);
    });
}

}  // namespace talus::serve
