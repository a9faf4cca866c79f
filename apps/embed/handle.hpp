#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "call.hpp"
#include "core/geometry.hpp"
#include "core/grid.hpp"
#include "core/try.hpp"
#include "hooks.hpp"
#include "twin/live_run.hpp"
#include "twin/scenario.hpp"

namespace talus::embed {

/// What the pointers that are returned point to, beside the scenario. Each answer is made once, so that reading leaves
/// earlier answers valid, and forgotten with the next change.
struct Answers {
    std::optional<std::string> message;
    std::map<std::string, std::string, std::less<>> json;
    struct Map {
        GridGeometry geometry;
        Buffer<float> values;
    };
    std::map<std::string, Map, std::less<>> maps;
    std::map<std::size_t, std::string> structure_names;
    struct Front {
        Buffer<double> chainage, arrival_time, velocity;
    };
    std::optional<Front> front;
    /// The debris at a time within the last step.
    struct Moment {
        Buffer<float> x, y, z, velocity_x, velocity_y, velocity_z;
    };
    std::map<double, Moment> moments;
    struct Surface {
        Buffer<float> positions, normals, depth, speed;
        Buffer<std::uint32_t> indices;
    };
    std::optional<Surface> surface;
    std::string created;
};

/// The debris before the last step, for a time between the two.
struct Before {
    std::uint64_t step = 0;
    double time = 0;  ///< s
    struct Particle {
        LocalPoint position, velocity;
        bool present = false;
    };
    std::vector<Particle> of_id;
};

}  // namespace talus::embed

struct talus_simulation {
    std::unique_ptr<talus::twin::Scenario> scenario;
    bool can_be_saved = true;
    bool changing = false;  ///< a call that changes it has not returned
    std::optional<talus::embed::Before> before = {};
    mutable talus::embed::Answers answers = {};
};

namespace talus::embed {

/// The time of a call that changes a simulation.
class Changing {
  public:
    [[nodiscard]] static Status check(const talus_simulation* simulation) {
        TALUS_TRY(need(simulation, "simulation"));
        if (simulation->changing) return Error{"simulation: a call that changes it has not returned yet"};
        return {};
    }
    explicit Changing(talus_simulation& simulation) : simulation_(simulation) {
        simulation_.changing = true;
        simulation_.answers = {};
    }
    ~Changing() { simulation_.changing = false; }
    Changing(const Changing&) = delete;
    Changing& operator=(const Changing&) = delete;

  private:
    talus_simulation& simulation_;
};

}  // namespace talus::embed
