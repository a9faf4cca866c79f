#include "design/design.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "design/parts.hpp"
#include "design/search.hpp"
#include "ensemble/ensemble_folder.hpp"
#include "ensemble/run_record.hpp"
#include "geo/vector.hpp"

namespace talus::design {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string folder_name(std::size_t line, const std::string& name) {
    std::string made;
    for (const char c : name) {
        const auto u = static_cast<unsigned char>(c);
        made += std::isalnum(u) != 0 && u < 128 ? static_cast<char>(std::tolower(u)) : '_';
    }
    return fmt::format("{}_{}", line, made.substr(0, 40));
}

/// "x,y x,y ..."; nothing: it is something else.
std::optional<std::vector<PlanPoint>> points_of(std::string_view text) {
    std::vector<PlanPoint> points;
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto number = [&](double& value) {
        const auto [stopped, error] = std::from_chars(at, end, value);
        at = stopped;
        return error == std::errc() && std::isfinite(value);
    };
    while (at != end) {
        if (*at == ' ') {
            ++at;
            continue;
        }
        PlanPoint p;
        if (!number(p.x) || at == end || *at != ',') return std::nullopt;
        ++at;
        if (!number(p.y) || (at != end && *at != ' ')) return std::nullopt;
        points.push_back(p);
    }
    return points;
}

Result<SiteLine> read_site(const std::string& text, const scene::Scene& scene) {
    const auto refused = [&](const std::string& why) { return Error{fmt::format("--line \"{}\": {}", text, why)}; };
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
        return refused("write NAME=x,y x,y ... or NAME=FILE");
    }
    SiteLine line;
    line.name = text.substr(0, equals);
    const std::string place = text.substr(equals + 1);
    if (auto points = points_of(place)) {
        line.points = *std::move(points);
    } else {
        std::error_code error;
        if (!fs::exists(place, error)) {
            return refused(fmt::format("{} is neither a file nor places such as 824199,825691 824233,825675", place));
        }
        auto read = geo::read_line(place, "", scene.crs);
        if (!read) return refused(read.error().message);
        line.points = std::move(read->points);
    }
    if (line.points.size() < 2) return refused("has one place; a line needs at least two");
    return line;
}

Result<SiteLine> own_line(const DesignRequest& request, const scene::Scene& scene) {
    std::vector<std::string> names;
    for (const terrain::Building& building : scene.buildings) {
        if (!building.barrier) continue;
        if (building.name == request.barrier) return SiteLine{request.barrier, building.barrier->line};
        names.push_back(building.name);
    }
    for (const params::OptionSpec& option : scene.spec.options) {
        if (std::find(option.barriers.begin(), option.barriers.end(), request.barrier) == option.barriers.end())
            continue;
        return Error{
            fmt::format("--barrier \"{0}\": is there only with the option \"{1}\"; add --set "
                        "scene.option=\"{1}\"",
                        request.barrier, option.name)};
    }
    return Error{fmt::format("{}: there is no barrier \"{}\"; barriers: {}", scene.file.string(), request.barrier,
                             names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")))};
}

Status check_request(const DesignRequest& request) {
    if (!(request.share >= 0) || request.share >= 1) {
        return Error{fmt::format("--share {:g} is refused; it must be from 0 to below 1", request.share)};
    }
    if (request.boulder_diameter && !(*request.boulder_diameter > 0 && *request.boulder_diameter <= 20)) {
        return Error{fmt::format("--boulder-diameter {:g} is refused; it must be above 0 and at most 20 m",
                                 *request.boulder_diameter)};
    }
    if (request.deposition_slope && !(*request.deposition_slope >= 0 && *request.deposition_slope < 60)) {
        return Error{fmt::format("--deposition-slope {:g} is refused; it must be from 0 to below 60 degrees",
                                 *request.deposition_slope)};
    }
    for (const ensemble::Factor& factor : request.plan.factors) {
        if (factor.key.starts_with("barrier") || factor.key == "scene.option") {
            return Error{fmt::format("factor {}: is refused; the barrier is what is designed", factor.key)};
        }
    }
    return {};
}

fs::path extra_file(const fs::path& folder, std::size_t run) {
    return folder / "barrier" / fmt::format("{:06}.json", run);
}

/// That of the runs, and what the files of a definition do not say.
void define(const Design& design, const scene::Scene& scene, Part& part) {
    Json definition = ensemble_definition(*part.runs, part.source, scene, design.request.scene_name);
    Json points = Json::array();
    for (const PlanPoint& p : design.lines[part.line].points) points.push_back({p.x, p.y});
    definition["design"] = {
        {"barrier", design.request.barrier}, {"line", points}, {"height_m", part.height}, {"numbers", part.numbers}};
    part.definition = std::make_shared<const Json>(std::move(definition));
}

}  // namespace

Part make_part(const Design& design, std::size_t line, double height) {
    Part part;
    part.line = line;
    part.height = height;
    part.source = design.request.source;
    part.runs = design.runs;
    for (std::size_t k = 0; k < part.runs->count(); ++k) part.numbers.push_back(k);
    part.folder = design.request.folder / folder_name(line, design.lines[line].name) /
                  (height > 0 ? fmt::format("height_{:g}", height) : "without");
    define(design, *design.scene, part);
    return part;
}

/// The same runs with particles, those of `numbers`.
Result<Part> particle_part(const Design& design, std::size_t line, double height,
                           const std::vector<std::size_t>& numbers) {
    Part part = make_part(design, line, height);
    part.particles = true;
    part.numbers = numbers;
    part.source.overrides.emplace_back("solver.model=particles");
    TALUS_ASSIGN(const scene::Scene scene, scene::load_scene(part.source.file, part.source.overrides));
    TALUS_ASSIGN(ensemble::PlannedRuns runs, ensemble::PlannedRuns::make(design.request.plan, part.source, scene));
    stats::Points points;
    for (const std::size_t number : numbers) points.push_back(design.runs->points()[number]);
    runs.set_points(std::move(points));
    part.runs = std::make_shared<const ensemble::PlannedRuns>(std::move(runs));
    part.folder = part.folder.parent_path() / fmt::format("particles_{:g}", height);
    define(design, scene, part);
    return part;
}

Result<PartRuns> read_part(const Part& part) {
    const auto folder = ensemble::EnsembleFolder::join(part.folder, *part.definition);
    PartRuns made;
    for (std::size_t run = 0; run < part.runs->count(); ++run) {
        TALUS_ASSIGN(ensemble::RunRecord record, ensemble::read_run_record(folder.run_file(run), folder.plan(), run));
        made.runs.emplace_back();
        if (record.complete()) {
            TALUS_ASSIGN(made.runs.back(), read_barrier_run(extra_file(part.folder, run)));
        }
        made.records.push_back(std::move(record));
    }
    return made;
}

std::size_t Design::most_runs() const {
    return lines.size() * (1 + most_trials(heights.size())) * runs->count();
}

std::size_t Design::missing_runs() const {
    std::size_t there = 0;
    const auto count = [&](std::size_t line, double height) {
        const fs::path runs_folder = make_part(*this, line, height).folder / "runs";
        std::error_code error;
        for (const fs::directory_entry& entry : fs::directory_iterator(runs_folder, error)) {
            there += entry.path().extension() == ".run" ? 1 : 0;
        }
    };
    for (std::size_t line = 0; line < lines.size(); ++line) {
        count(line, 0);
        for (const double height : heights) count(line, height);
    }
    return most_runs() - std::min(most_runs(), there);
}

Result<Design> plan_design(const DesignRequest& request) {
    TALUS_TRY(check_request(request));
    Design design;
    design.request = request;
    TALUS_ASSIGN(design.heights, height_grid(request.low, request.high, request.step));
    TALUS_ASSIGN(scene::Scene scene, scene::load_scene(request.source.file, request.source.overrides));
    leave_out_zoom(scene, "talus design");
    TALUS_ASSIGN(SiteLine own, own_line(request, scene));
    design.lines.push_back(std::move(own));
    for (const std::string& text : request.lines) {
        TALUS_ASSIGN(SiteLine line, read_site(text, scene));
        const bool twice = std::any_of(design.lines.begin(), design.lines.end(),
                                       [&](const SiteLine& l) { return l.name == line.name; });
        if (twice) return Error{fmt::format("--line \"{}\": another line has that name", text)};
        design.lines.push_back(std::move(line));
    }
    for (const SiteLine& line : design.lines) {
        for (const double height : {design.heights.front(), design.heights.back()}) {
            scene::Scene tried = scene;
            if (const Status s = place_barrier(tried, request.barrier, line, height); !s) {
                return Error{
                    fmt::format("line \"{}\" with a height of {:g} m: {}", line.name, height, s.error().message)};
            }
        }
    }
    if (request.confirm && scene.spec.solver.model == params::ModelChoice::particles) {
        return Error{"--confirm particles is refused; the scene's model is particles, with which the search is made"};
    }
    TALUS_ASSIGN(ensemble::PlannedRuns runs, ensemble::PlannedRuns::make(request.plan, request.source, scene));
    if (runs.count() < 2) return Error{fmt::format("--runs {} is refused; a design needs at least 2", runs.count())};
    design.runs = std::make_shared<const ensemble::PlannedRuns>(std::move(runs));
    design.scene = std::make_shared<const scene::Scene>(std::move(scene));
    return design;
}

Status open_part(const Part& part) {
    std::error_code error;
    fs::create_directories(part.folder.parent_path(), error);  // opening says what is wrong with it
    const auto opened = ensemble::EnsembleFolder::open(part.folder, *part.definition);
    if (!opened) return opened.error();
    fs::create_directories(part.folder / "barrier", error);  // writing says so
    return {};
}

Result<ensemble::EnsembleOutcome> run_part(const Design& design, const Part& part, ensemble::EnsembleOptions options) {
    const auto folder = ensemble::EnsembleFolder::join(part.folder, *part.definition);
    const SiteLine& line = design.lines[part.line];
    const std::string& barrier = design.request.barrier;
    options.prepare = [&](scene::Scene& scene) {
        leave_out_zoom(scene, "talus design");
        return place_barrier(scene, barrier, line, part.height);
    };
    options.keep = [&](std::size_t run, const run::RunResult& result) {
        const double least = design.scene->spec.outputs.arrival_depth;
        return write_barrier_run(extra_file(part.folder, run), barrier_run(result, barrier, line, least));
    };
    options.kept = [&](std::size_t run) { return read_barrier_run(extra_file(part.folder, run)).ok(); };
    return run_ensemble(*part.runs, part.source, folder, options);
}

}  // namespace talus::design
