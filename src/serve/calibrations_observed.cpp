// What calibrations fit: the observations of the first scenario.
#include <filesystem>
#include <utility>

#include "core/try.hpp"
#include "params/scene_text.hpp"
#include "products/text_file.hpp"
#include "serve/calibrations.hpp"

namespace talus::serve {

std::vector<messages::CalibratedObservation> Calibrations::listed(
    const std::vector<ensemble::ObservedValue>& observed) {
    std::vector<messages::CalibratedObservation> list;
    list.reserve(observed.size());
    for (const ensemble::ObservedValue& o : observed) {
        list.push_back({.name = o.name,
                        .unit = o.unit,
                        .observed = o.value,
                        .uncertainty = o.uncertainty,
                        .is = o.is(),
                        .best = {},
                        .deviation = {}});
    }
    return list;
}

std::optional<std::string> Calibrations::why_none(const std::vector<ensemble::ObservedValue>& observed,
                                                  const run::SceneSource& source) {
    if (source.file.empty()) return "This program serves the scene without calibrations.";
    if (!observed.empty()) return {};
    return "Scenario A has no field observations to calibrate against. Add them on the tab Points, or in the scene "
           "file.";
}

void Calibrations::follow(std::vector<twin::TableEntry> observations) {
    const std::lock_guard lock(mutex_);
    followed_ = std::move(observations);
    if (!busy_ && !closed_) take_observations();
}

void Calibrations::take_observations() {
    if (followed_ == taken_) return;
    taken_ = followed_;
    scene_ = opened_;
    if (taken_ != entries_of(opened_->spec, twin::TableKind::observation)) {
        auto scene = std::make_shared<scene::Scene>(*opened_);
        put_entries(scene->spec, twin::TableKind::observation, taken_);
        scene_ = std::move(scene);
    }
    observed_ = ensemble::observed_values(*scene_);
    status_.why_not = why_none(observed_, settings_.source);
    // What a former calibration found is beside the observations that it had.
    if (calibration_.state == State::idle) status_.observations = listed(observed_);
    tell_now();
}

Result<run::SceneSource> Calibrations::source_of_runs() const {
    if (scene_ == opened_) return settings_.source;
    const auto now = entries_of(scene_->spec, twin::TableKind::observation);
    TALUS_ASSIGN(params::SceneSpec spec, scene::parse_scene(settings_.source.file, settings_.source.overrides));
    put_entries(spec, twin::TableKind::observation, now);
    const std::filesystem::path file = settings_.folder / "scene_observed.toml";
    TALUS_TRY(products::write_text_file(file, params::write_short_scene(spec)));
    return run::SceneSource{file, {}};
}

}  // namespace talus::serve
