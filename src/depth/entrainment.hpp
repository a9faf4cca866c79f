#pragma once

#include <vector>

#include "depth/solver.hpp"
#include "terrain/bed.hpp"

namespace talus::depth {

/// Entrainment of the bed: ground becomes debris at rest in the cell above it, by the laws of the particles
/// (sim/sources/entrainment.hpp). Debris keeps its momentum and loses speed; the bed sinks by what it gains.
class Entrainment {
  public:
    /// Without any bed.
    Entrainment() = default;
    /// `bed`: a value per cell of the solver's grid.
    explicit Entrainment(terrain::Bed bed) : bed_(std::move(bed)), loose_(bed_.depth.size()) {}

    /// Entrains what came loose in the solver's last step; returns its volume, m3.
    double entrain(Solver& solver);
    [[nodiscard]] const terrain::Bed& bed() const { return bed_; }
    /// What has been eroded, of the same bed.
    template <class Archive>
    void keep(Archive& archive) {
        const std::size_t cells = loose_.size();
        archive(bed_.eroded, loose_);
        if constexpr (Archive::reading) {
            if (bed_.eroded.size() != bed_.depth.size() || loose_.size() != cells) archive.fail();
        }
    }

  private:
    [[nodiscard]] double loosened(const Solver& solver, const terrain::BedMaterial& material, std::size_t cell,
                                  double depth, double speed, double square_slope) const;

    terrain::Bed bed_;
    std::vector<double> loose_;  ///< m, less than elevations are rounded to, by cell
};

}  // namespace talus::depth
