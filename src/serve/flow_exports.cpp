#include "serve/flow_exports.hpp"

#include <algorithm>
#include <exception>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/fields.hpp"
#include "serve/api.hpp"
#include "serve/library.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr params::Range interval_range{.low = 0.001, .high = 1e7};  // s, as outputs.series_interval_s

void delete_all(const fs::path& folder) {
    std::error_code ignored;
    if (!folder.empty()) fs::remove_all(folder, ignored);
}

std::vector<std::string> files_of(const std::vector<std::string>& formats) {
    std::vector<std::string> files;
    for (const twin::RecordedFlow::Format& format : twin::RecordedFlow::formats()) {
        if (std::find(formats.begin(), formats.end(), format.name) == formats.end()) continue;
        for (const std::string_view file : format.files) {
            if (std::find(files.begin(), files.end(), file) == files.end()) files.emplace_back(file);
        }
    }
    return files;
}

const char* type_of(const std::string& name) {
    if (name.ends_with(".glb")) return "model/gltf-binary";
    if (name.ends_with(".json")) return "application/json";
    return name.ends_with(".tif") ? "image/tiff" : "application/netcdf";
}

}  // namespace

FlowExports::FlowExports(Session& session, fs::path folder)
    : session_(session), folder_(std::move(folder)), writer_(session.executor(), "flow export", Priority::idle) {}

FlowExports::~FlowExports() {
    close();
}

void FlowExports::close() {
    {
        const std::lock_guard lock(mutex_);
        *job_.stop = true;
    }
    writer_.close();
    const std::lock_guard lock(mutex_);
    delete_all(job_.folder);
    job_ = {};
}

void FlowExports::offer(const std::string& scenario, std::optional<double> interval, const Respond& respond) {
    session_.loop().post([this, scenario, interval, respond](Scenarios& all) {
        const auto index = all.find(scenario);
        if (!index) return respond(no_scenario(scenario));
        session_.worker().post([scenario, interval, respond, flow = twin::recorded_flow_of(all.at(*index))] {
            messages::FlowOffer offered = flow->describe(interval.value_or(flow->default_interval()));
            offered.scenario = scenario;
            respond(json_response(200, offered));
        });
    });
}

Result<FlowExports::Wanted> FlowExports::read(const std::string& body) {
    TALUS_ASSIGN(const json wanted, read_object(body, {"formats", "interval_s"}));
    Wanted result;
    const auto formats = wanted.find("formats");
    if (formats == wanted.end() || !formats->is_array()) return Error{"formats: is a list of names"};
    for (const json& name : *formats) {
        if (!name.is_string()) return Error{fmt::format("formats = {}; each is a name", twin::shown(name))};
        result.formats.push_back(name.get<std::string>());
    }
    TALUS_ASSIGN(const auto interval, twin::read_number(wanted, "interval_s", interval_range, "s"));
    result.interval = interval.value_or(0);
    return result;
}

void FlowExports::start(const std::string& scenario, const std::string& body, const Respond& respond) {
    auto wanted = read(body);
    if (!wanted) return respond(error_response(400, wanted.error().message));
    session_.loop().post([this, scenario, wanted = std::move(*wanted), respond](Scenarios& all) {
        const auto index = all.find(scenario);
        respond(index ? begin(scenario, twin::recorded_flow_of(all.at(*index)), wanted) : no_scenario(scenario));
    });
}

Response FlowExports::begin(const std::string& scenario, const std::shared_ptr<const twin::RecordedFlow>& flow,
                            const Wanted& asked) {
    Wanted wanted = asked;
    if (wanted.interval == 0) wanted.interval = flow->default_interval();
    if (const Status possible = flow->check(wanted.formats, wanted.interval); !possible) {
        return error_response(400, possible.error().message);
    }
    const std::lock_guard lock(mutex_);
    if (job_.is_open()) {
        return error_response(409,
                              fmt::format("The moving flow of scenario {} is being written ({:.0f} %). Wait for it "
                                          "or cancel it.",
                                          job_.scenario, 100 * job_.share));
    }
    delete_all(job_.folder);
    job_ = {};
    job_.state = Job::State::running;
    job_.scenario = scenario;
    job_.files = files_of(wanted.formats);
    job_.folder = folder_ / fmt::format("flow-{}", ++count_);
    writer_.post([this, flow, wanted, job = job_] { write(*flow, wanted, job); });
    return json_response(200, describe_now());
}

void FlowExports::write(const twin::RecordedFlow& flow, const Wanted& wanted, const Job& job) {
    const auto go_on = [&](double share) {
        const std::lock_guard lock(mutex_);
        job_.share = share;
        return !*job.stop;
    };
    try {
        std::error_code failed;
        fs::create_directories(job.folder, failed);
        const Status written = failed ? Status(Error{fmt::format("{}: {}", job.folder.string(), failed.message())})
                                      : flow.write(wanted.formats, wanted.interval, job.folder, go_on);
        if (written) return end(Job::State::done, "");
        if (*job.stop) return end(Job::State::cancelled, "");
        end(Job::State::failed, without_folder(written.error().message, job.folder));
    } catch (const std::exception& error) {  // running out of memory here must not end the live run
        end(Job::State::failed, fmt::format("The export ended unexpectedly: {}.", error.what()));
    }
}

void FlowExports::end(Job::State state, std::string message) {
    const std::lock_guard lock(mutex_);
    job_.end(state, std::move(message));
    if (state == Job::State::done) return;
    delete_all(job_.folder);
    job_.files.clear();
}

messages::FlowExport FlowExports::describe_now() const {
    messages::FlowExport told{.state = job_.state_name(),
                              .scenario = messages::if_any(job_.scenario),
                              .share = job_.is_open() ? std::optional(job_.share) : std::nullopt,
                              .message = job_.message,
                              .files = {}};
    if (job_.state != Job::State::done) return told;
    for (const std::string& name : job_.files) {
        std::error_code gone;
        const auto bytes = fs::file_size(job_.folder / name, gone);
        if (!gone) told.files.push_back({.name = name, .bytes = bytes});
    }
    return told;
}

messages::FlowExport FlowExports::describe() const {
    const std::lock_guard lock(mutex_);
    return describe_now();
}

void FlowExports::cancel() {
    const std::lock_guard lock(mutex_);
    if (job_.is_open()) {
        job_.cancel();
        return;
    }
    delete_all(job_.folder);
    job_ = {};
}

void FlowExports::file(const std::string& name, const Respond& respond) const {
    fs::path path;
    {
        const std::lock_guard lock(mutex_);
        // A name is compared with those of the files: none leads out of the folder.
        const bool there = std::find(job_.files.begin(), job_.files.end(), name) != job_.files.end();
        if (there && job_.state == Job::State::done) path = job_.folder / name;
    }
    if (path.empty()) {
        return respond(error_response(404, fmt::format("there is no file {} of the moving flow", tidy_name(name, 40))));
    }
    session_.worker().post([files = sent_, path, name, respond] {
        auto bytes = files->read(path);
        if (!bytes) return respond(error_response(500, bytes.error().message));
        Response response;
        response.type = type_of(name);
        response.body = std::move(*bytes);
        response.file_name = name;
        respond(response);
    });
}

}  // namespace talus::serve
