#include "observe/discharge.hpp"

#include <algorithm>
#include <cmath>

namespace talus::observe {
namespace {

BarrierLine line_of(const terrain::Terrain& terrain, const terrain::CrossSection& section) {
    params::BarrierSpec shape;
    shape.line = section.line;
    return {terrain, shape};
}

}  // namespace

DischargeRecorder::DischargeRecorder(const std::vector<terrain::CrossSection>& sections) {
    for (const terrain::CrossSection& section : sections) records_.push_back({.section = section});
}

void DischargeRecorder::end_interval(DischargeRecord& record, double time) {
    const DischargeSample before = record.rows.empty() ? DischargeSample{} : record.rows.back();
    const double discharge = (record.passed - before.passed) / (time - before.time);
    if (std::abs(discharge) > std::abs(record.peak_discharge)) {
        record.peak_discharge = discharge;
        record.peak_time = time;
    }
    record.rows.push_back({time, discharge, record.passed});
}

void DischargeRecorder::after_step(double time) {
    for (DischargeRecord& record : records_) {
        // At the first step at or after a multiple of the interval; a millionth of it absorbs rounding.
        const double interval = record.section.interval;
        const double last = record.rows.empty() ? 0 : record.rows.back().time;
        if (std::floor(time / interval + 1e-6) > std::floor(last / interval + 1e-6)) end_interval(record, time);
    }
}

std::vector<DischargeRecord> DischargeRecorder::records(double time) const {
    std::vector<DischargeRecord> all = records_;
    for (DischargeRecord& record : all) {
        const double last = record.rows.empty() ? 0 : record.rows.back().time;
        // A short rest of an interval says nothing about the peak.
        const DischargeRecord before = record;
        if (time > last) end_interval(record, time);
        if (time - last < record.section.interval / 2 && !before.rows.empty()) {
            record.peak_discharge = before.peak_discharge;
            record.peak_time = before.peak_time;
        }
    }
    return all;
}

ParticleSections::ParticleSections(const sim::Model& model, const terrain::Terrain& terrain,
                                   const std::vector<terrain::CrossSection>& sections, const Debris& debris)
    : recorder_(sections), particle_volume_(model.particle_volume()) {
    for (const terrain::CrossSection& section : sections) {
        Line line{.line = line_of(terrain, section), .near = {}, .tracks = {}};
        // No particle moves farther in a step than a few spacings.
        line.near = line.line.extent().grown(std::max(2.0, 4 * model.particle_spacing));
        lines_.push_back(std::move(line));
    }
    after_step(debris);
}

void ParticleSections::after_step(const Debris& debris) {
    if (lines_.empty()) return;
    ++calls_;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        recorder_.pass(k, static_cast<double>(cross(lines_[k], debris)) * particle_volume_);
    }
    if (debris.summary().step > 0) recorder_.after_step(debris.summary().time);
}

std::int64_t ParticleSections::cross(Line& line, const Debris& debris) {
    const std::uint32_t seeded = debris.summary().seeded;
    if (line.tracks.size() < seeded) line.tracks.resize(seeded);
    const auto rounded = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    const Extent& e = line.near;
    debris.find_inside({rounded(e.x_min), rounded(e.y_min), rounded(e.x_max), rounded(e.y_max)}, false, inside_);
    std::int64_t net = 0;
    for (const PlacedParticle& particle : inside_) {
        Track& track = line.tracks[particle.id];
        const Track before = track;
        track = {particle.position.x, particle.position.y, calls_};
        const bool known = before.call > 0 && before.call + 1 == calls_;
        if (!known || (before.x == track.x && before.y == track.y)) continue;
        net += line.line.crossing({before.x, before.y}, {track.x, track.y}).net;
    }
    return net;
}

GridSections::GridSections(const depth::Solver& solver, const terrain::Terrain& terrain,
                           const std::vector<terrain::CrossSection>& sections, std::size_t first_face)
    : first_face_(first_face), recorder_(sections) {
    const GridGeometry& g = solver.geometry();
    const WorldPoint& origin = terrain.frame().origin;
    const auto local_centre = [&](int column, int row) {
        const PlanPoint p = g.centre(column, row);
        return PlanPoint{p.x - origin.x, p.y - origin.y};
    };
    for (std::size_t k = 0; k < sections.size(); ++k) {
        const BarrierLine line = line_of(terrain, sections[k]);
        const Extent near = line.extent().grown(2 * g.cell);
        for (int row = 0; row < g.rows; ++row) {
            for (int column = 0; column < g.columns; ++column) {
                const PlanPoint at = local_centre(column, row);
                if (!near.contains(at) || !solver.known(column, row)) continue;
                for (const bool north : {false, true}) {
                    const int c = column + (north ? 0 : 1), r = row + (north ? 1 : 0);
                    if (c >= g.columns || r >= g.rows || !solver.known(c, r)) continue;
                    const int net = line.crossing(at, local_centre(c, r)).net;
                    if (net == 0) continue;
                    faces_.push_back({column, row, north});
                    crossings_.push_back({k, static_cast<double>(net)});
                }
            }
        }
    }
}

void GridSections::after_step(const depth::Solver& solver) {
    for (std::size_t k = 0; k < crossings_.size(); ++k) {
        recorder_.pass(crossings_[k].section, crossings_[k].sign * solver.passed()[first_face_ + k]);
    }
    recorder_.after_step(solver.time());
}

}  // namespace talus::observe
