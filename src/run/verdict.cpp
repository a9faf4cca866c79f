#include "run/verdict.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "core/number_or_null.hpp"
#include "run/words.hpp"
#include "sim/compression.hpp"

namespace talus::run {
namespace {

struct Kind {
    std::string_view key, name, unit;
};
constexpr std::array<Kind, 5> kinds{{{"resolution", "Resolution", "particles"},
                                     {"compression", "Compression", ""},
                                     {"energy", "Energy", ""},
                                     {"still_moving", "Still moving", ""},
                                     {"convergence", "Convergence", ""}}};

Check new_check(const Kind& kind) {
    Check check;
    check.key = kind.key;
    check.name = kind.name;
    check.unit = kind.unit;
    return check;
}

CheckState compare_with_limit(bool within) {
    return within ? CheckState::within : CheckState::beyond;
}

Check resolution(const RunResult& result) {
    Check check = new_check(kinds[0]);
    const observe::FlowThickness& flow = result.observation.thickness;
    if (result.depth_averaged()) {
        check.text = fmt::format(
            "Not measured with the depth-averaged model (cells of {:.4g} m); compare with half of "
            "solver.grid_cell_m",
            result.grid_cell);
        return check;
    }
    if (!flow.known() || !(result.particle_spacing > 0)) {
        check.text = "Not measured: debris reached no map cell";
        return check;
    }
    check.value = flow.median / result.particle_spacing;
    check.limit = observe::FlowThickness::min_layers;
    check.state = compare_with_limit(check.value >= check.limit);
    check.text =
        fmt::format("The flow is {:.1f} particles thick in the median of its trail{}", check.value,
                    check.state == CheckState::within
                        ? ""
                        : fmt::format(", fewer than {:.0f}: depths, speeds and forces mean little", check.limit));
    return check;
}

Check compression(const RunResult& result) {
    Check check = new_check(kinds[1]);
    if (result.depth_averaged()) {
        check.text = "Not measured: the depth-averaged model keeps the volume of its debris";
        return check;
    }
    const observe::Compression& c = result.observation.compression;
    check.value = c.time_share_above;
    check.limit = observe::Compression::time_share_limit;
    check.state = compare_with_limit(c.within_limits());
    check.text =
        check.state == CheckState::within
            ? fmt::format("Debris compressed by at most {} % on average", rounded(100 * c.worst_mean, 2))
            : fmt::format("Debris too compressed during {} % of the simulated time", rounded(100 * check.value, 2));
    return check;
}

std::string speed_text(const observe::Energy& e) {
    if (!(e.share > observe::Energy::share_limit)) {
        return fmt::format("Speeds are at most {:.0f} % of free fall from the crown", 100 * std::sqrt(e.share));
    }
    return fmt::format(
        "The flow is faster than its fall explains: {} m/s at ({:.0f}, {:.0f}), where a fall of "
        "{} m allows {} m/s, and so in {} of {} map cells; speeds and pressures there are wrong, "
        "run-out is doubtful",
        rounded(e.speed, 3), e.at.x, e.at.y, rounded(e.fall, 3), rounded(e.allowed_speed, 3), e.cells_above, e.cells);
}

Check energy(const RunResult& result) {
    Check check = new_check(kinds[2]);
    check.limit = observe::Energy::share_limit;
    const observe::Energy& own = result.observation.energy;
    const bool of_event = result.zoom && !result.zoom->energy.within_limits();
    const observe::Energy& e = of_event ? result.zoom->energy : own;
    if (!e.known()) {
        check.limit = observe::never;
        check.text = "Not measured: debris reached no map cell";
        return check;
    }
    check.value = e.share;
    check.state = compare_with_limit(e.within_limits());
    check.text =
        of_event ? "In the depth-averaged run that feeds the zoom, " + uncapitalised(speed_text(e)) : speed_text(e);
    if (e.gained > observe::Energy::gained_limit) {
        check.text += fmt::format("; the debris has gained {} % of the energy of its whole fall by t = {:.4g} s",
                                  rounded(100 * e.gained, 2), e.gained_time);
    }
    return check;
}

Check still_moving(const RunResult& result) {
    Check check = new_check(kinds[3]);
    if (result.status != RunStatus::complete || result.observation.timeseries.empty()) {
        check.text = "Not known before the run has come to its end";
        return check;
    }
    const StillMoving moving = result.still_moving();
    check.limit = still_moving_limit;
    check.value = moving.share;
    check.state = compare_with_limit(check.value <= check.limit);
    check.text =
        check.state == CheckState::within
            ? fmt::format("{} % of the debris still moved at the end", rounded(100 * check.value, 2))
            : fmt::format(
                  "{} % of the debris ({} m3) still moved at the end, t = {:.4g} s: run-out "
                  "and deposit are lower bounds",
                  rounded(100 * check.value, 2), rounded(moving.volume, 3), result.observation.timeseries.back().time);
    return check;
}

Check convergence(const std::vector<Comparison>& comparisons) {
    Check check = new_check(kinds[4]);
    for (const Comparison& comparison : comparisons) {
        if (comparison.kind != ComparisonKind::convergence) continue;
        const Answer converged = comparison.converged();
        if (converged != Answer::unknown) check.state = compare_with_limit(converged == Answer::yes);
        check.text = capitalised(comparison.verdict_text());
        return check;
    }
    check.text = "Not tested; talus run --convergence compares with finer numerics";
    return check;
}

/// Nearer to its limit, or further beyond it.
bool is_worse(const Check& a, const Check& b) {
    if (a.state != b.state) {
        const auto rank = [](CheckState s) { return s == CheckState::beyond ? 2 : s == CheckState::within ? 1 : 0; };
        return rank(a.state) > rank(b.state);
    }
    return a.key == "resolution" ? a.value < b.value : a.value > b.value;
}

}  // namespace

const char* state_name(CheckState state) {
    switch (state) {
        case CheckState::within:
            return "within";
        case CheckState::beyond:
            return "beyond";
        case CheckState::not_measured:
            break;
    }
    return "not_measured";
}

const Check& RunVerdict::check(std::string_view key) const {
    const auto found = std::find_if(checks.begin(), checks.end(), [&](const Check& c) { return c.key == key; });
    assert(found != checks.end());
    return *found;
}

bool RunVerdict::within_limits() const {
    return std::none_of(checks.begin(), checks.end(), [](const Check& c) { return c.state == CheckState::beyond; });
}

std::string RunVerdict::text() const {
    std::string names;
    for (const Check& check : checks) {
        if (check.state != CheckState::beyond) continue;
        names += (names.empty() ? "" : ", ") + uncapitalised(std::string(check.name));
    }
    return names.empty() ? "Within limits" : "Beyond limits: " + names;
}

std::string RunVerdict::keys() const {
    std::string keys;
    for (const Check& check : checks) {
        if (check.state != CheckState::beyond) continue;
        keys += (keys.empty() ? "" : " ") + std::string(check.key);
    }
    return keys;
}

std::vector<std::string> RunVerdict::warnings() const {
    std::vector<std::string> warnings;
    for (const Check& check : checks) {
        if (check.state == CheckState::beyond)
            warnings.push_back(fmt::format("{}: {}", check.name, uncapitalised(check.text)));
    }
    return warnings;
}

RunVerdict judge(const RunResult& result, const std::vector<Comparison>& comparisons) {
    return {{resolution(result), compression(result), energy(result), still_moving(result), convergence(comparisons)}};
}

RunVerdict judge_together(const std::vector<RunVerdict>& verdicts) {
    RunVerdict all;
    for (const RunVerdict& verdict : verdicts) {
        for (const Check& check : verdict.checks) {
            const auto worst =
                std::find_if(all.checks.begin(), all.checks.end(), [&](const Check& c) { return c.key == check.key; });
            if (worst == all.checks.end()) {
                all.checks.push_back(check);
            } else if (is_worse(check, *worst)) {
                *worst = check;
            }
        }
    }
    for (Check& check : all.checks) {
        const auto beyond = std::count_if(verdicts.begin(), verdicts.end(), [&](const RunVerdict& verdict) {
            return std::any_of(verdict.checks.begin(), verdict.checks.end(),
                               [&](const Check& c) { return c.key == check.key && c.state == CheckState::beyond; });
        });
        if (beyond == 0) continue;
        check.text = fmt::format("Beyond its limit in {} of {} runs; in the worst, {}", beyond, verdicts.size(),
                                 uncapitalised(check.text));
    }
    return all;
}

nlohmann::ordered_json verdict_json(const RunVerdict& verdict) {
    using Json = nlohmann::ordered_json;
    Json checks = Json::array();
    for (const Check& c : verdict.checks) {
        checks.push_back({{"key", c.key},
                          {"name", c.name},
                          {"state", state_name(c.state)},
                          {"value", number_or_null<Json>(c.value)},
                          {"limit", number_or_null<Json>(c.limit)},
                          {"unit", c.unit},
                          {"text", c.text}});
    }
    return {{"within_limits", verdict.within_limits()},
            {"text", verdict.text()},
            {"warnings", verdict.warnings()},
            {"checks", std::move(checks)}};
}

RunVerdict verdict_of(const nlohmann::ordered_json& checks) {
    const auto number = [](const nlohmann::ordered_json& j) {
        return j.is_number() ? j.get<double>() : observe::never;
    };
    RunVerdict verdict;
    for (const auto& json : checks) {
        const auto key = json.at("key").get<std::string>(), state = json.at("state").get<std::string>();
        const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) { return k.key == key; });
        if (kind == kinds.end()) continue;
        Check check = new_check(*kind);
        check.state = state == state_name(CheckState::beyond)   ? CheckState::beyond
                      : state == state_name(CheckState::within) ? CheckState::within
                                                                : CheckState::not_measured;
        check.value = number(json.at("value"));
        check.limit = number(json.at("limit"));
        check.text = json.at("text").get<std::string>();
        verdict.checks.push_back(std::move(check));
    }
    return verdict;
}

}  // namespace talus::run
