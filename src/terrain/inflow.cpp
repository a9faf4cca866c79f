#include "terrain/inflow.hpp"

#include <algorithm>
#include <cmath>

namespace talus::terrain {
namespace {

/// Integral of a column from the first row until `time`: exact, as it is linear between rows.
double integral(const std::vector<params::InflowSample>& rows, double params::InflowSample::*column, double time) {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < rows.size() && time > rows[k].time; ++k) {
        const double length = rows[k + 1].time - rows[k].time;
        const double share = time < rows[k + 1].time ? (time - rows[k].time) / length : 1;
        const double begin = rows[k].*column, rise = rows[k + 1].*column - begin;
        sum += length * share * (begin + rise * share / 2);
    }
    return sum;
}

/// A column at a time, that of the first or last row outside the hydrograph.
double value_at(const std::vector<params::InflowSample>& rows, double params::InflowSample::*column, double time) {
    const auto after = std::upper_bound(rows.begin(), rows.end(), time,
                                        [](double t, const params::InflowSample& row) { return t < row.time; });
    if (after == rows.begin()) return rows.front().*column;
    if (after == rows.end()) return rows.back().*column;
    const params::InflowSample &a = *(after - 1), &b = *after;
    return a.*column + (b.*column - a.*column) * (time - a.time) / (b.time - a.time);
}

}  // namespace

double Inflow::volume_until(double time) const {
    return integral(hydrograph, &params::InflowSample::discharge, time);
}

double Inflow::way_until(double time) const {
    return integral(hydrograph, &params::InflowSample::velocity, time);
}

double Inflow::mass_until(double time) const {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < hydrograph.size() && time > hydrograph[k].time; ++k) {
        const params::InflowSample &a = hydrograph[k], &b = hydrograph[k + 1];
        const double length = b.time - a.time, share = time < b.time ? (time - a.time) / length : 1;
        const double rise = b.discharge - a.discharge, denser = b.density - a.density;
        // A product of two straight lines, integrated.
        sum += length * share *
               (a.discharge * a.density +
                share * ((a.discharge * denser + rise * a.density) / 2 + share * rise * denser / 3));
    }
    return sum;
}

double Inflow::mean_thickness() const {
    double way = 0;
    for (std::size_t k = 0; k + 1 < hydrograph.size(); ++k) {
        const params::InflowSample &a = hydrograph[k], &b = hydrograph[k + 1];
        if (a.discharge + b.discharge > 0) way += (b.time - a.time) * (a.velocity + b.velocity) / 2;
    }
    const double covered = way * std::hypot(to.x - from.x, to.y - from.y);
    return covered > 0 ? volume() / covered : 0;
}

double Inflow::velocity_at(double time) const {
    return value_at(hydrograph, &params::InflowSample::velocity, time);
}

double Inflow::pore_pressure_ratio_at(double time) const {
    return value_at(hydrograph, &params::InflowSample::pore_pressure_ratio, time);
}

double Inflow::density_between(double early, double late) const {
    const double volume = volume_until(late) - volume_until(early);
    // Too little to divide by: no inflow, or for too short a time.
    if (!(volume > 1e-9 * this->volume())) return value_at(hydrograph, &params::InflowSample::density, late);
    return (mass_until(late) - mass_until(early)) / volume;
}

}  // namespace talus::terrain
