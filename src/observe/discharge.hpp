#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry.hpp"
#include "depth/solver.hpp"
#include "observe/barrier_line.hpp"
#include "observe/debris.hpp"
#include "observe/observation.hpp"
#include "sim/model.hpp"
#include "sim/state.hpp"
#include "terrain/cross_section.hpp"
#include "terrain/terrain.hpp"

namespace talus::observe {

/// Records what passes cross-sections, of either model: discharge is the net volume of an interval over its length.
class DischargeRecorder {
  public:
    DischargeRecorder() = default;
    explicit DischargeRecorder(const std::vector<terrain::CrossSection>& sections);

    /// In the step that ends now, m3, from the line's left to its right.
    void pass(std::size_t section, double volume) { records_[section].passed += volume; }
    /// Ends a step at `time`, s.
    void after_step(double time);
    /// With a row for what is left of an interval.
    [[nodiscard]] std::vector<DischargeRecord> records(double time) const;

    /// The records of the same sections.
    template <class Archive>
    void keep(Archive& archive) {
        for (DischargeRecord& r : records_) {
            archive(r.passed, r.peak_discharge, r.peak_time, r.rows);
        }
    }

  private:
    static void end_interval(DischargeRecord& record, double time);

    std::vector<DischargeRecord> records_;
};

/// Particles that cross lines from one step to the next, each in the direction of its way.
class ParticleSections {
  public:
    ParticleSections() = default;
    ParticleSections(const sim::Model& model, const terrain::Terrain& terrain,
                     const std::vector<terrain::CrossSection>& sections, const Debris& debris);

    void after_step(const Debris& debris);
    /// Call when particles may have been moved between two steps: that is no crossing.
    void forget_places() { ++calls_; }
    [[nodiscard]] std::vector<DischargeRecord> records(double time) const { return recorder_.records(time); }

    template <class Archive>
    void keep(Archive& archive) {
        for (Line& line : lines_) archive(line.tracks);
        archive(recorder_, calls_);
    }

  private:
    struct Track {
        float x = 0, y = 0;
        std::uint64_t call = 0;  ///< of the last place; 0: none
    };
    struct Line {
        BarrierLine line;
        Extent near;                ///< local: what is farther away crosses nothing in a step
        std::vector<Track> tracks;  ///< by particle id
    };
    /// How many particles have crossed, less those back.
    [[nodiscard]] std::int64_t cross(Line& line, const Debris& debris);

    std::vector<Line> lines_;
    DischargeRecorder recorder_;
    std::vector<PlacedParticle> inside_;
    double particle_volume_ = 0;
    std::uint64_t calls_ = 0;
};

/// The same on the grid: the volumes that the solver moves through the faces between cells on either side of the line,
/// so that nothing is lost or counted twice.
class GridSections {
  public:
    GridSections() = default;
    /// `first_face`: index of the first of faces() in what the solver watches.
    GridSections(const depth::Solver& solver, const terrain::Terrain& terrain,
                 const std::vector<terrain::CrossSection>& sections, std::size_t first_face);

    /// What the solver must count for it (Solver::watch).
    [[nodiscard]] const std::vector<depth::Face>& faces() const { return faces_; }
    void after_step(const depth::Solver& solver);
    [[nodiscard]] std::vector<DischargeRecord> records(double time) const { return recorder_.records(time); }

    template <class Archive>
    void keep(Archive& archive) {
        archive(recorder_);
    }

  private:
    struct Crossing {
        std::size_t section = 0;
        double sign = 0;  ///< 1: east or north is from the line's left to its right
    };
    std::size_t first_face_ = 0;
    std::vector<depth::Face> faces_;
    std::vector<Crossing> crossings_;  ///< by face
    DischargeRecorder recorder_;
};

}  // namespace talus::observe
