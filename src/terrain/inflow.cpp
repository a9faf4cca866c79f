#include "terrain/inflow.hpp"

namespace talus {
namespace {

/// Integral of a column from the first row until `time`: exact, as it is linear between rows.
double integral(const std::vector<InflowSample>& rows, double InflowSample::*column, double time) {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < rows.size() && time > rows[k].time; ++k) {
        const double length = rows[k + 1].time - rows[k].time;
        const double share = time < rows[k + 1].time ? (time - rows[k].time) / length : 1;
        const double begin = rows[k].*column, rise = rows[k + 1].*column - begin;
        sum += length * share * (begin + rise * share / 2);
    }
    return sum;
}

}  // namespace

double Inflow::volume_until(double time) const {
    return integral(hydrograph, &InflowSample::discharge, time);
}

double Inflow::way_until(double time) const {
    return integral(hydrograph, &InflowSample::velocity, time);
}

}  // namespace talus
