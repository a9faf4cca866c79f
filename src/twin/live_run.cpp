#include "twin/live_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/try.hpp"
#include "sim/compression.hpp"
#include "twin/pore_pressure_map.hpp"

namespace talus::twin {
Result<std::unique_ptr<LiveRun>> LiveRun::start(const scene::Scene& scene, const Setup& setup, double spacing,
                                                const ScenarioOptions& options, const sim::Progress& progress) {
    TALUS_ASSIGN(auto run, run::Run::start(scene_of(scene, setup), spacing, progress));
    return std::unique_ptr<LiveRun>(new LiveRun(std::move(run), scene, setup, options));
}

LiveRun::LiveRun(std::unique_ptr<run::Run> run, const scene::Scene& scene, Setup setup, const ScenarioOptions& options)
    : run_(std::move(run)),
      begun_with_(std::move(setup)),
      setup_(begun_with_),
      slots_(run_->summary().seeded),
      recording_(options.frame_interval, options.recording_bytes),
      clock_(run_->model().solver),
      deposited_speed_(scene.spec.outputs.deposited_speed),
      alarms_(scene) {
    for (const ReleaseSetup& release : setup_.releases) groups_.push_back({release.id, false});
    for (const BuildingSetup& building : setup_.buildings) obstacles_.push_back({building.id, building.body});
    for (const BarrierSetup& barrier : setup_.barriers) obstacles_.push_back({barrier.id, barrier.body, true});
    alarms_.watch(setup_);
    record();
}

bool LiveRun::has_begun(const std::string& release_id) const {
    const Group* group = find_id(groups_, release_id);
    return group != nullptr && group->begun;
}

double LiveRun::start_time_of(const std::string& release_id) const {
    const Group* group = find_id(groups_, release_id);
    return model().releases[static_cast<std::size_t>(group - groups_.data())].start_time;
}

bool LiveRun::too_compressed() const {
    return sim::too_compressed(summary());
}

const run::RunVerdict& LiveRun::verdict() const {
    const auto begun = std::chrono::steady_clock::now();
    const bool ended = phase() != judged_.phase;
    const bool changed = judged_.verdict.checks.empty() || judged_.step != summary().step || ended;
    if (!changed || (begun < judged_.next && !ended)) return judged_.verdict;
    judged_.verdict = run_->verdict();
    judged_.step = summary().step;
    judged_.phase = phase();
    const auto taken = std::chrono::steady_clock::now() - begun;
    judged_.next = begun + std::max<std::chrono::steady_clock::duration>(std::chrono::seconds(1), 100 * taken);
    return judged_.verdict;
}

FramePtr LiveRun::frame(unsigned stride, unsigned flags) const {
    const observe::MapAccumulator::Present present = observer().maps().present();
    auto frame = std::make_shared<Frame>(
        make_frame(state(), present, slots_, stride, flags | (too_compressed() ? frame_too_compressed : 0)));
    frame->rest_density = model().rest_density;
    frame->pore_pressure = pore_pressure_map(model(), ground(), state(), present.depth);
    return frame;
}

void LiveRun::record() {
    if (!recording_.due(summary().time)) return;
    recording_.add(frame(1, 0));
    record_impacts();
    erosion_history_.add(summary().time, summary().entrained, ground().bed.eroded);
}

void LiveRun::record_impacts() {
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        const bool untouched = !observer().impacts()[k].hit && !obstacles_[k].barrier;
        if (obstacles_[k].stands && !untouched) impact_history_.add(k, summary().time, impact_now(k));
    }
}

void LiveRun::advance() {
    if (phase() != run::RunPhase::ready) return;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        groups_[g].begun = groups_[g].begun || model().releases[g].start_time <= summary().time;
    }
    const bool stepped = run_->advance();
    slots_ = std::max(slots_, summary().seeded);  // debris was injected or entrained
    if (!stepped) return;
    note_failed();
    record();
    alarms_.check(*this);
    // Where steps wait for real time, looks between them are as cheap as these are slow.
    const auto now = std::chrono::steady_clock::now();
    constexpr double longest_step = 1;  // s; what takes longer is a pause
    going_ += std::min(longest_step, std::chrono::duration<double>(now - stepped_at_).count());
    stepped_at_ = now;
    clock_.tick(going_, summary().time, [this] { return outlook(); });
}

run::Outlook LiveRun::outlook() const {
    run::Outlook outlook = run::outlook_of(run_->simulation(), deposited_speed_);
    for (const InflowSetup& inflow : begun_with_.inflows) {
        outlook.wait = std::max(outlook.wait, inflow.body->hydrograph.back().time - summary().time);
    }
    return outlook;
}

std::optional<double> LiveRun::expected_end() const {
    if (phase() != run::RunPhase::ready) return summary().time;
    if (summary().step == 0 || clock_.expected_end() <= summary().time) return {};
    return clock_.expected_end();
}

std::optional<double> LiveRun::wall_remaining() const {
    if (phase() != run::RunPhase::ready) return 0;
    if (!expected_end() || std::isnan(clock_.wall_remaining())) return {};
    return clock_.wall_remaining();
}

observe::BuildingImpact LiveRun::impact_now(std::size_t obstacle) const {
    observe::BuildingImpact impact = observer().impacts()[obstacle];
    if (const observe::Overtopping* crossings = observer().overtopping(obstacle)) {
        impact.retained_volume = crossings->filling(state()).volume;
    }
    return impact;
}

observe::BuildingImpact LiveRun::impact_on(const std::string& obstacle_id, std::optional<double> time) const {
    const auto k = static_cast<std::size_t>(find_id(obstacles_, obstacle_id) - obstacles_.data());
    if (!time) return impact_now(k);
    observe::BuildingImpact impact = impact_history_.at(k, *time);
    impact.name = observer().impacts()[k].name;
    return impact;
}

const observe::BuildingImpact* LiveRun::measured_on(const std::string& obstacle_id) const {
    const Obstacle* obstacle = find_id(obstacles_, obstacle_id);
    if (obstacle == nullptr) return nullptr;
    return &observer().impacts()[static_cast<std::size_t>(obstacle - obstacles_.data())];
}

void LiveRun::follow_gauge(const std::string& inflow_id, const std::shared_ptr<const terrain::Inflow>& body) {
    InflowSetup* begun = find_id(begun_with_.inflows, inflow_id);
    run_->follow_gauge(static_cast<std::size_t>(begun - begun_with_.inflows.data()), body->hydrograph);
    for (InflowSetup* entry : {begun, find_id(setup_.inflows, inflow_id)}) {
        entry->body = body;
        entry->as_in_scene = false;
    }
}

std::vector<float> LiveRun::eroded(std::optional<double> time) const {
    if (summary().entrained == 0) return {};
    return time ? erosion_history_.at(*time) : ground().bed.eroded;
}

std::vector<LiveRun::Removed> LiveRun::removed() const {
    std::vector<Removed> removed;
    for (const Obstacle& obstacle : obstacles_) {
        if (obstacle.stands || obstacle.until_step <= obstacle.since_step) continue;
        removed.push_back({obstacle.id, obstacle.body, obstacle.barrier, obstacle.last});
    }
    return removed;
}

void LiveRun::note_failed() {
    for (const std::size_t k : observer().failed_buildings()) {
        obstacles_[k].stands = false;
        obstacles_[k].failed = true;
        impact_history_.add(k, summary().time, impact_now(k));
    }
}

run::RunResult LiveRun::result() const {
    run::RunResult result = run_->result("written while running,");
    std::vector<observe::BuildingImpact> standing;
    const auto take = [&](const auto& entries) {
        for (const auto& entry : entries) {
            const auto k = static_cast<std::size_t>(find_id(obstacles_, entry.id) - obstacles_.data());
            standing.push_back(std::move(result.observation.buildings[k]));
        }
    };
    take(setup_.buildings);
    take(setup_.barriers);
    for (const Removed& removed : this->removed()) standing.push_back(removed.impact);
    result.observation.buildings = std::move(standing);
    return result;
}

}  // namespace talus::twin
