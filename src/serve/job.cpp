#include "serve/job.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/try.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"
#include "validate/suite.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

constexpr std::array kind_names = {"ensemble", "calibration", "validation", "risk", "options", "design"};
/// The command of each.
constexpr std::array command_names = {"ensemble", "calibrate", "validate", "risk", "options", "design"};
constexpr std::size_t most_cases = 200;

/// Position of a name in a list of names.
template <class Names>
std::optional<std::size_t> position(const Names& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return {};
    return static_cast<std::size_t>(std::distance(names.begin(), found));
}

Result<std::string> name_in(const json& body, const char* key) {
    const auto found = body.find(key);
    if (found == body.end() || !found->is_string() || found->get_ref<const std::string&>().empty()) {
        return Error{fmt::format("{}: is needed, a name", key)};
    }
    return found->get<std::string>();
}

Status is_key(const json& key) {
    const std::string text = key.is_string() ? key.get<std::string>() : "";
    if (text.empty()) return Error{"key: is needed, a name"};
    const bool plain = std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '[' || c == ']';
    });
    if (!plain) return Error{fmt::format("key = {}: is no key of a scene", twin::shown(key))};
    return {};
}

Status read_factors(const json& body, std::size_t most, WantedJob& wanted) {
    const auto list = body.find("factors");
    if (list == body.end() || !list->is_array() || list->empty() || list->size() > most) {
        return Error{fmt::format("factors: must be a list of 1 to {}, each with key, low and high", most)};
    }
    for (const json& entry : *list) {
        TALUS_ASSIGN(const ensemble::Factor read, read_factor(entry, "factors", is_key));
        const std::string factor =
            fmt::format("{}={:.9g}:{:.9g}", read.key, read.distribution.low, read.distribution.high);
        TALUS_TRY(add_factor(wanted.ensemble, factor));
        wanted.factors.push_back(factor);
    }
    if (wanted.ensemble.factors.size() < wanted.factors.size()) return Error{"factors: a key is given twice"};
    return {};
}

Result<std::size_t> read_runs(const json& body, std::size_t usual) {
    const auto runs = body.find("runs");
    if (runs == body.end()) return usual;
    if (!runs->is_number_unsigned() || runs->get<std::uint64_t>() < 1 || runs->get<std::uint64_t>() > JobLimits::runs) {
        return Error{
            fmt::format("runs = {}: must be a whole number from 1 to {}", twin::shown(*runs), JobLimits::runs)};
    }
    return runs->get<std::size_t>();
}

Status read_design(const json& body, ensemble::EnsemblePlan& plan) {
    if (!body.contains("design")) return {};
    TALUS_ASSIGN(const std::string name, name_in(body, "design"));
    const auto design = stats::design_of(name);
    if (!design || *design == stats::DesignKind::grid) {
        std::vector<std::string> names;
        for (const auto& known : stats::design_names()) {
            if (stats::design_of(known) != stats::DesignKind::grid) names.emplace_back(known);
        }
        return Error{
            fmt::format("design = {}: must be one of {}", twin::shown(body["design"]), fmt::join(names, ", "))};
    }
    plan.design = *design;
    return {};
}

/// A number of the body, or what the command has.
Result<double> read_number(const json& body, const char* key, double usual) {
    const auto found = body.find(key);
    if (found == body.end()) return usual;
    if (!found->is_number()) return Error{fmt::format("{} = {}: must be a number", key, twin::shown(*found))};
    return found->get<double>();
}

/// What a design wants beside an ensemble; whether it can be had, the design says.
Status read_barrier(const json& body, design::DesignRequest& request) {
    TALUS_ASSIGN(request.barrier, name_in(body, "barrier"));
    TALUS_ASSIGN(request.share, read_number(body, "share", request.share));
    TALUS_ASSIGN(request.low, read_number(body, "min_height_m", request.low));
    TALUS_ASSIGN(request.high, read_number(body, "max_height_m", request.high));
    const json of = body.value("of", json("runs")), confirm = body.value("confirm", json("none"));
    if (of != "runs" && of != "volume") {
        return Error{fmt::format("of = {}: must be runs or volume", twin::shown(of))};
    }
    if (confirm != "none" && confirm != "particles") {
        return Error{fmt::format("confirm = {}: must be none or particles", twin::shown(confirm))};
    }
    request.of_volume = of == "volume";
    request.confirm = confirm == "particles";
    return {};
}

std::vector<std::string> barrier_arguments(const design::DesignRequest& request) {
    // The name with its option: it may begin with a dash.
    return {"--barrier=" + request.barrier,
            fmt::format("--share={}", request.share),
            request.of_volume ? "--of=volume" : "--of=runs",
            fmt::format("--min-height={}", request.low),
            fmt::format("--max-height={}", request.high),
            request.confirm ? "--confirm=particles" : "--confirm=none"};
}

/// Which keys the body of a kind has.
Status check_wanted_keys(const json& body, JobKind kind) {
    switch (kind) {
        case JobKind::validation:
            return twin::check_keys(body, {"kind", "quick", "cases"});
        case JobKind::calibration:
            return twin::check_keys(body, {"kind", "scene", "factors", "runs"});
        case JobKind::design:
            return twin::check_keys(body, {"kind", "scene", "factors", "runs", "design", "barrier", "share", "of",
                                           "min_height_m", "max_height_m", "confirm"});
        default:
            return twin::check_keys(body, {"kind", "scene", "factors", "runs", "design"});
    }
}

Status read_cases(const json& body, WantedJob& wanted) {
    if (const auto quick = body.find("quick"); quick != body.end()) {
        if (!quick->is_boolean()) return Error{"quick: is true or false"};
        wanted.quick = quick->get<bool>();
    }
    const auto list = body.find("cases");
    if (list == body.end()) return {};
    if (!list->is_array() || list->size() > most_cases) {
        return Error{fmt::format("cases: must be a list of up to {} names", most_cases)};
    }
    const std::vector<std::string> known = validate::builtin_case_names();
    for (const json& name : *list) {
        if (!name.is_string() || !position(known, name.get<std::string>()))
            return Error{fmt::format("cases: {} is no case of the program", twin::shown(name))};
        wanted.cases.push_back(name.get<std::string>());
    }
    return {};
}

/// For a shell: only what needs quotes has them.
std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || std::string_view("_-./=:,+@%").find(static_cast<char>(c)) != std::string::npos;
    });
    if (plain) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

}  // namespace

Result<ensemble::Factor> read_factor(const json& entry, const char* list,
                                     const std::function<Status(const json& key)>& check_key) {
    if (!entry.is_object()) return Error{fmt::format("{}: each is an object with key, low and high", list)};
    TALUS_TRY(twin::check_keys(entry, {"key", "low", "high"}));
    const json key = entry.value("key", json());
    TALUS_TRY(check_key(key));
    const auto number = [&](const char* name) {
        const auto found = entry.find(name);
        return found != entry.end() && found->is_number() ? found->get<double>() : std::nan("");
    };
    ensemble::Factor factor{key.get<std::string>(), {}};
    factor.distribution.kind = stats::DistributionKind::uniform;
    factor.distribution.low = number("low");
    factor.distribution.high = number("high");
    if (!(factor.distribution.low < factor.distribution.high)) {
        return Error{fmt::format("{}: low and high must be numbers, low below high", factor.key)};
    }
    return factor;
}

bool is_risk(JobKind kind) {
    return kind == JobKind::risk || kind == JobKind::options;
}

const char* job_kind_name(JobKind kind) {
    return kind_names[static_cast<std::size_t>(kind)];
}

Result<WantedJob> read_wanted_job(const json& body) {
    WantedJob wanted;
    if (!body.is_object()) return Error{"the body is an object with kind"};
    TALUS_ASSIGN(const std::string kind, name_in(body, "kind"));
    const auto known = position(kind_names, kind);
    if (!known) {
        return Error{
            fmt::format("kind = {}: must be one of {}", twin::shown(body["kind"]), fmt::join(kind_names, ", "))};
    }
    wanted.kind = static_cast<JobKind>(*known);
    TALUS_TRY(check_wanted_keys(body, wanted.kind));
    if (wanted.kind == JobKind::validation) {
        TALUS_TRY(read_cases(body, wanted));
        return Result<WantedJob>(std::move(wanted));
    }
    const bool calibration = wanted.kind == JobKind::calibration;
    TALUS_ASSIGN(wanted.scene, name_in(body, "scene"));
    TALUS_TRY(read_factors(body, calibration ? JobLimits::calibration_factors : JobLimits::ensemble_factors, wanted));
    wanted.calibration.factors = wanted.ensemble.factors;
    if (wanted.kind == JobKind::design) {
        wanted.ensemble.runs = 32;  // of each height, as the command has it
        TALUS_TRY(read_barrier(body, wanted.design));
    }
    TALUS_ASSIGN(wanted.ensemble.runs, read_runs(body, wanted.ensemble.runs));
    TALUS_ASSIGN(wanted.calibration.search.runs, read_runs(body, wanted.calibration.search.runs));
    TALUS_TRY(read_design(body, wanted.ensemble));
    using enum stats::DesignKind;
    const bool sample = wanted.ensemble.design == latin_hypercube || wanted.ensemble.design == monte_carlo ||
                        wanted.ensemble.design == sobol;
    if ((is_risk(wanted.kind) || wanted.kind == JobKind::design) && !sample) {
        return Error{
            fmt::format("design = {}: must be latin_hypercube, monte_carlo or sobol, whose points are a sample",
                        twin::shown(body["design"]))};
    }
    return Result<WantedJob>(std::move(wanted));
}

std::vector<std::string> arguments_of(const WantedJob& wanted, const std::filesystem::path& scene,
                                      const std::filesystem::path& folder) {
    std::vector<std::string> words;
    if (wanted.kind == JobKind::validation) {
        words = {"validate"};
        words.insert(words.end(), wanted.cases.begin(), wanted.cases.end());
        if (wanted.quick) words.emplace_back("--quick");
        for (const auto& [option, file] : {std::pair{"--html", report_of(wanted.kind)},
                                           {"--results", "results.json"},
                                           {"--json-file", "table.json"}}) {
            words.insert(words.end(), {option, (folder / file).string()});
        }
        words.emplace_back("--known");
        return words;
    }
    words = {command_names.at(static_cast<std::size_t>(wanted.kind))};
    if (!scene.empty()) words.push_back(scene.string());
    for (const std::string& factor : wanted.factors) words.insert(words.end(), {"--vary", factor});
    if (wanted.kind != JobKind::calibration) {
        words.insert(words.end(), {"--runs", std::to_string(wanted.ensemble.runs)});
        words.insert(words.end(), {"--design", stats::design_name(wanted.ensemble.design)});
    } else {
        words.insert(words.end(), {"--runs", std::to_string(wanted.calibration.search.runs)});
    }
    if (wanted.kind == JobKind::design) {
        const std::vector<std::string> more = barrier_arguments(wanted.design);
        words.insert(words.end(), more.begin(), more.end());
    }
    words.insert(words.end(), {"--output", folder.string()});
    return words;
}

std::string command_text(const std::vector<std::string>& arguments) {
    std::string text = "talus";
    for (const std::string& word : arguments) text += " " + quoted(word);
    return text;
}

void take_progress(Job& job, const json& event) {
    const auto count_of = [&](const char* key, std::size_t& to) {
        const auto found = event.find(key);
        if (found != event.end() && found->is_number_unsigned()) to = found->get<std::size_t>();
    };
    const json kind = event.is_object() ? event.value("event", json()) : json();
    if (kind == "progress") {
        for (const char* key : {"runs_done", "cases_done"}) count_of(key, job.done);
        count_of("runs_failed", job.failed);
        for (const char* key : {"runs", "runs_at_most", "cases"}) count_of(key, job.count);
        const auto left = event.find("wall_remaining_s");
        job.wall_remaining =
            left != event.end() && left->is_number() ? std::optional(left->get<double>()) : std::nullopt;
    } else if (kind == "result" && job.kind != JobKind::validation) {
        count_of("complete", job.done);
        count_of("failed", job.failed);
        if (const auto failed = event.find("failed"); failed != event.end() && failed->is_array()) {
            job.failed = failed->size();
        }
    } else if (kind == "result") {
        std::size_t passed = 0, failed = 0, announced = 0, skipped = 0;
        count_of("passed", passed);
        count_of("failed", failed);
        count_of("known_failures", announced);
        count_of("skipped_cases", skipped);
        job.message = fmt::format("{} values pass, {} fail, {} known failures", passed, failed, announced);
        if (skipped > 0) job.message += fmt::format("; {} cases were skipped, their data are missing", skipped);
    }
}

const char* report_of(JobKind kind) {
    switch (kind) {
        case JobKind::validation:
            return "validation.html";
        case JobKind::design:
            return "design.html";
        default:
            return "report.html";
    }
}

std::string job_text(const Job& job) {
    return session::to_text({{"talus_job", 1},
                             {"id", job.id},
                             {"kind", job_kind_name(job.kind)},
                             {"state", job.state_name()},
                             {"title", job.title},
                             {"scene", job.scene},
                             {"arguments", job.arguments},
                             {"message", job.message},
                             {"begun_at", job.begun_at},
                             {"ended_at", job.ended_at},
                             {"process", job.process},
                             {"done", job.done},
                             {"failed", job.failed},
                             {"count", job.count}}) +
           "\n";
}

Result<Job> read_job(const std::string& text) {
    TALUS_ASSIGN(const json file, session::parse_json(text));
    if (!file.is_object() || file.value("talus_job", json()) != 1) return Error{"this is no job of a start page"};
    try {
        Job job;
        const auto kind = position(kind_names, file.at("kind").get<std::string>());
        const auto state = position(Job::state_names, file.at("state").get<std::string>());
        if (!kind || !state || *state == 0) return Error{"this is a job of another version"};
        job.kind = static_cast<JobKind>(*kind);
        job.state = static_cast<Job::State>(*state);
        file.at("id").get_to(job.id);
        file.at("title").get_to(job.title);
        file.at("scene").get_to(job.scene);
        file.at("arguments").get_to(job.arguments);
        file.at("message").get_to(job.message);
        file.at("begun_at").get_to(job.begun_at);
        file.at("ended_at").get_to(job.ended_at);
        file.at("process").get_to(job.process);
        file.at("done").get_to(job.done);
        file.at("failed").get_to(job.failed);
        file.at("count").get_to(job.count);
        return Result<Job>(std::move(job));
    } catch (const json::exception&) {
        return Error{"this is a job of another version"};
    }
}

}  // namespace talus::serve
