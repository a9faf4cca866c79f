#pragma once

#include "core/grid.hpp"
#include "observe/observation.hpp"

namespace talus::observe {

/// Follows the energy of the debris from row to row of the time series, against that with which it came. Heights are
/// above one level at or below the lowest ground, that of TimeSample::potential_energy. What a model cannot say exactly
/// is counted so that it hides energy gained rather than invents it: debris that leaves takes none with it.
class EnergyAccount {
  public:
    explicit EnergyAccount(double gravity) : gravity_(gravity) {}

    /// Debris that came in with `energy`, J: its mass, kg, and its highest energy line: the height of its surface at
    /// rest, with the velocity head of inflow, m. `thickness`: vertical, m.
    void bring(double mass, double energy, double highest, double thickness);
    /// The setup was changed: `now` is the debris after it. Energy gained so far stays.
    void follow(const TimeSample& now, double mass);
    /// Every row of the time series. `present`: mass of the debris whose energies it has, kg; `density`, kg/m3.
    void add(const TimeSample& row, double present, double density);

    template <class Archive>
    void keep(Archive& archive) {
        archive(highest_, thickness_, brought_, brought_mass_, total_, entrained_, mean_height_, gained_, gained_time_);
    }

    /// m/s, the greatest speed that a fall to the level explains.
    [[nodiscard]] double greatest_speed() const;

    /// `ground`: on the cells of the maps, above the level; NaN: unknown. `slack`, m: by how much a cell may lie below
    /// its ground, for the scheme.
    [[nodiscard]] Energy measure(const HazardMaps& maps, const Grid<float>& ground, double slack) const;

  private:
    double gravity_;
    double highest_ = -1e300, thickness_ = 0;  ///< m
    double brought_ = 0, brought_mass_ = 0;    ///< J, kg
    double total_ = 0, entrained_ = 0, mean_height_ = 0;
    double gained_ = never, gained_time_ = never;  ///< J, s: the most of all rows
};

}  // namespace talus::observe
