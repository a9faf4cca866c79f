#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "params/spec.hpp"
#include "scene/scene.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

class LiveRun;

/// An alarm of the setup that a run has raised.
struct RaisedAlarm {
    std::string name;
    std::string sentence;  ///< "front at chainage 212 m, 48 m before House 38"
    std::string message;   ///< of the scene; may be empty
    double time = 0;       ///< s, when it was raised
    std::optional<double>
        expected;  ///< s, when the front is at the place, or what is warned of happens; empty: not known
    std::uint64_t step = 0;
    std::uint64_t hash = 0;  ///< of the state after that step
};

/// Watches a run for the alarms of its setup: each is raised once. Depends only on the run, so a replay raises the
/// same.
class AlarmWatch {
  public:
    explicit AlarmWatch(const scene::Scene& scene);

    /// From now on for the alarms of this setup: one that is new or changed can be raised.
    void watch(const Setup& setup);

    /// After every step.
    void check(const LiveRun& run);
    [[nodiscard]] const std::vector<RaisedAlarm>& raised() const { return raised_; }

  private:
    struct Rule {
        std::string id;
        std::shared_ptr<const TableEntry> body;
        params::AlarmSpec spec;
        std::string obstacle;  ///< its id in the setup; empty: the place is none
        bool raised = false;
    };
    /// What is known of the front; velocity: m/s, empty while it does not advance.
    struct Front {
        double chainage = 0;
        std::optional<double> velocity;
    };
    /// What a rule has found.
    struct Finding {
        std::string sentence;
        std::optional<double> expected;
    };
    [[nodiscard]] static Front front_of(const LiveRun& run);
    [[nodiscard]] static std::optional<Finding> approach(const Rule& rule, const LiveRun& run, const Front& front);
    [[nodiscard]] static std::optional<Finding> load(const Rule& rule, const LiveRun& run);
    [[nodiscard]] static std::optional<Finding> find(const Rule& rule, const LiveRun& run);

    std::map<std::string, std::string> scene_ids_;  ///< of its structures, by the names in the scene
    std::vector<Rule> rules_;
    std::size_t waiting_ = 0;  ///< rules not raised
    double next_look_ = 0;     ///< s
    std::vector<RaisedAlarm> raised_;
};

}  // namespace talus::twin
