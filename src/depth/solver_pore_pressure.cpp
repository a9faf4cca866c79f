// Pore pressure and solid fraction that debris carries.
#include <cmath>
#include <optional>
#include <vector>

#include "depth/soil.hpp"
#include "depth/solver.hpp"

namespace talus::depth {
namespace {

/// Of the pore pressure that all debris refers to: then it is reckoned anew.
constexpr double least_left = 1e-15;

}  // namespace

Solver::Start Solver::start_of(std::optional<double> pore_pressure_ratio, std::optional<double> solid_fraction) const {
    const double ratio = material_.pore_pressure_ratio;
    if (!material_.soil.on) return {pore_pressure_ratio.value_or(ratio), 0};
    const double fraction = solid_fraction.value_or(material_.soil.solid_fraction);
    const double own = ratio > 0 ? ratio : hydrostatic_ratio(material_.soil, fraction);
    return {pore_pressure_ratio.value_or(own), fraction};
}

void Solver::carry_pore_pressure() {
    pore_pressure_.assign(depth_.size(), static_cast<float>(start_of({}, {}).pore_pressure_ratio));
    next_pore_pressure_ = pore_pressure_;
    drained_from_ = time_;
}

/// Excess pressure falls as the first mode of consolidation does (Hutchinson 1986; see sim/physics/resistance.hpp).
void Solver::drain() {
    const double decay = material_.pore_pressure_decay_time;
    if (!carries_pore_pressure() || !(decay > 0)) return;
    pore_pressure_left_ = std::exp((drained_from_ - time_) / decay);
    if (pore_pressure_left_ > least_left) return;
    // Debris that starts or comes in now would no longer fit into a float beside that of then.
    const auto left = static_cast<float>(pore_pressure_left_);
    for (std::vector<float>* array : {&pore_pressure_, &next_pore_pressure_}) {
        for (float& pressure : *array) pressure *= left;
    }
    drained_from_ = time_;
    pore_pressure_left_ = 1;
}

}  // namespace talus::depth
