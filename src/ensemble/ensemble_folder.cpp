#include "ensemble/ensemble_folder.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/file.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "products/text_file.hpp"

namespace talus::ensemble {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr int format_version = 2;  // of the files of runs

/// Keys that may differ within the same ensemble: path and author of the scene, and the thresholds.
bool is_incidental(const std::string& key) {
    return key == "scene" || key == "program_version" || key == "thresholds" || key == "return_period_years";
}

std::string shortened(const Json& value) {
    std::string text = value.dump();
    return text.size() > 120 ? text.substr(0, 117) + "..." : text;
}

/// Files that a killed process was writing. The folder is locked.
void remove_leftovers(const fs::path& folder) {
    std::error_code ignored;
    std::vector<fs::path> leftovers;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        if (products::is_unfinished_file(entry.path())) leftovers.push_back(entry.path());
    }
    for (const fs::path& leftover : leftovers) fs::remove(leftover, ignored);
}

}  // namespace

Json ensemble_definition(const PlannedRuns& runs, const run::SceneSource& source, const scene::Scene& base,
                         const std::string& scene_name) {
    const EnsemblePlan& plan = runs.plan();
    Json inputs = Json::array();
    for (const scene::InputFile& input : base.inputs) inputs.push_back({{"role", input.role}, {"hash", input.hash}});
    Json factors = Json::array();
    for (const Factor& f : plan.factors)
        factors.push_back({{"key", f.key}, {"distribution", f.distribution.written()}});
    Json definition = {{"program", "talus"},
                       {"kind", "ensemble"},
                       {"program_version", TALUS_VERSION},
                       {"format", format_version},
                       {"scene", scene_name},
                       {"inputs", inputs},
                       {"overrides", source.overrides},
                       {"fixed", runs.fixed()},
                       {"design", design_name(plan.design)},
                       {"seed", plan.seed},
                       {"runs", runs.count()},
                       {"levels", plan.levels},
                       {"factors", factors},
                       {"thresholds",
                        {{"depth_m", plan.thresholds.depth},
                         {"speed_mps", plan.thresholds.speed},
                         {"pressure_kPa", plan.thresholds.pressure}}},
                       {"return_period_years", plan.return_period ? Json(*plan.return_period) : Json()}};
    // Without them as earlier versions wrote it, so that their folders can be resumed.
    if (plan.fast_runs > 0) definition["fast_runs"] = plan.fast_runs;
    return definition;
}

std::string difference(const Json& there, const Json& wanted) {
    for (const auto& [key, value] : wanted.items()) {
        if (is_incidental(key)) continue;
        const Json found = there.contains(key) ? there[key] : Json();
        if (found != value) return fmt::format("{}: {}, not {}", key, shortened(found), shortened(value));
    }
    for (const auto& [key, value] : there.items()) {
        if (!is_incidental(key) && !wanted.contains(key)) return fmt::format("{}: {}, not null", key, shortened(value));
    }
    return "";
}

std::string plan_identity(const Json& definition) {
    Json identifying = Json::object();
    for (const auto& [key, value] : definition.items()) {
        if (!is_incidental(key)) identifying[key] = value;
    }
    const std::string text = identifying.dump(-1, ' ', false, Json::error_handler_t::replace);
    StateHash hash;
    hash.add(text.data(), text.size());
    return to_hex(hash.value());
}

Result<Json> read_definition(const fs::path& folder, const std::string& kind) {
    std::ifstream in(folder / "ensemble.json");
    Json json = Json::parse(in, nullptr, false);
    if (!json.is_object() || json.value("program", Json()) != "talus" || json.value("kind", Json()) != kind) {
        return Error{fmt::format("{}: is no {} of talus (it has no ensemble.json)", folder.string(), kind)};
    }
    return json;
}

Result<EnsemblePlan> plan_of(const Json& definition) {
    EnsemblePlan plan;
    try {
        const auto design = stats::design_of(definition.at("design").get<std::string>());
        plan.design = design.value_or(stats::DesignKind::latin_hypercube);
        plan.runs = definition.at("runs").get<std::size_t>();
        plan.levels = definition.at("levels").get<std::size_t>();
        plan.fast_runs = definition.value("fast_runs", std::size_t{0});
        plan.seed = definition.at("seed").get<std::uint64_t>();
        const Json& thresholds = definition.at("thresholds");
        plan.thresholds = {thresholds.at("depth_m").get<std::vector<double>>(),
                           thresholds.at("speed_mps").get<std::vector<double>>(),
                           thresholds.at("pressure_kPa").get<std::vector<double>>()};
        // Ensembles of earlier versions do not have it.
        if (const Json years = definition.value("return_period_years", Json()); years.is_number()) {
            plan.return_period = years.get<double>();
        }
        for (const Json& f : definition.at("factors")) {
            const auto text = f.at("key").get<std::string>() + "=" + f.at("distribution").get<std::string>();
            TALUS_TRY(add_factor(plan, text));
        }
    } catch (const Json::exception& error) {
        return Error{fmt::format("ensemble.json: is not as talus writes it: {}", error.what())};
    }
    return plan;
}

Result<EnsembleFolder> EnsembleFolder::open(const fs::path& path, const Json& definition) {
    std::error_code error;
    if (fs::exists(path, error) && !fs::is_directory(path, error)) {
        return Error{path.string() + ": is a file, not a folder; name another output folder"};
    }
    const bool fresh = !fs::exists(path, error) || fs::is_empty(path, error);
    if (!fresh && !fs::exists(path / "ensemble.json", error) && !fs::exists(path / "lock", error)) {
        return Error{path.string() + ": exists and contains no ensemble; name another output folder"};
    }
    const auto cannot_be_made = [&] {
        return Error{fmt::format("{}: cannot be made: {}", path.string(), error.message())};
    };
    fs::create_directories(path, error);
    if (error) return cannot_be_made();

    EnsembleFolder folder;
    folder.path_ = path;
    folder.plan_ = plan_identity(definition);
    folder.lock_ = ::open((path / "lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    if (folder.lock_ < 0) return Error{fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno))};
    if (flock(folder.lock_, LOCK_EX | LOCK_NB) != 0) {
        return Error{errno == EWOULDBLOCK
                         ? fmt::format("{}: another process computes this ensemble; wait for it, or give every shard a "
                                       "folder of its own",
                                       path.string())
                         : fmt::format("{}: cannot be locked: {}", path.string(), std::strerror(errno))};
    }
    fs::create_directories(path / "runs", error);  // after the lock, by which the folder is known should this fail
    if (error) return cannot_be_made();
    if (fs::exists(path / "ensemble.json", error)) {
        TALUS_ASSIGN(const Json there, read_definition(path, definition.value("kind", "ensemble")));
        if (const std::string differs = difference(there, definition); !differs.empty()) {
            return Error{
                fmt::format("{}: holds another ensemble ({}); name another output folder", path.string(), differs)};
        }
    } else {
        TALUS_TRY(products::replace_text_file(path / "ensemble.json", definition.dump(2) + "\n"));
    }
    remove_leftovers(path);
    remove_leftovers(path / "runs");
    return Result<EnsembleFolder>(std::move(folder));
}

EnsembleFolder EnsembleFolder::join(const fs::path& path, const Json& definition) {
    EnsembleFolder folder;
    folder.path_ = path;
    folder.plan_ = plan_identity(definition);
    return folder;
}

EnsembleFolder::EnsembleFolder(EnsembleFolder&& other) noexcept
    : path_(std::move(other.path_)), plan_(std::move(other.plan_)), lock_(std::exchange(other.lock_, -1)) {}

EnsembleFolder::~EnsembleFolder() {
    if (lock_ >= 0) close(lock_);
}

fs::path EnsembleFolder::run_file(std::size_t run) const {
    return path_ / "runs" / fmt::format("{:06}.run", run);
}

Status take_runs(const fs::path& from, const EnsembleFolder& to, std::size_t count) {
    for (std::size_t run = 0; run < count; ++run) {
        const fs::path target = to.run_file(run), source = from / "runs" / target.filename();
        std::error_code error;
        if (!fs::exists(source, error) || fs::equivalent(source, target, error)) continue;
        TALUS_ASSIGN(const RunRecord there, read_run_record(source, to.plan(), run));
        if (const auto here = read_run_record(target, to.plan(), run); here) {
            if (here->hash == there.hash && here->fault == there.fault) continue;
            return Error{
                fmt::format("run {}: {} and {} hold different results", run, source.string(), target.string())};
        }
        fs::remove(target, error);
        fs::create_hard_link(source, target, error);
        if (error) fs::copy_file(source, target, error);
        if (error) return Error{fmt::format("{}: cannot be made: {}", target.string(), error.message())};
    }
    return {};
}

}  // namespace talus::ensemble
