#include "sim/physics/boundary_table.hpp"

#include <cmath>
#include <numbers>

namespace talus {
namespace {

constexpr int node_count = 257;  // over distances from -r to r

/// Integral of W over the plane at distance q r from the particle, times r: 2 pi * integral from q to 1 of W s ds.
template <class F>
double plane_integral(const F& value, double q) {
    constexpr int steps = 400;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double s = q + (1 - q) * (i + 0.5) / steps;
        sum += value(s) * s;
    }
    return 2 * std::numbers::pi * sum * (1 - q) / steps;
}

}  // namespace

BoundaryTable::BoundaryTable(const Kernel& kernel, double particle_spacing)
    : support_radius_(kernel.support_radius),
      inverse_step_((node_count - 1) / (2 * kernel.support_radius)),
      nodes_(node_count + 1) {
    with_kernel(kernel.choice, [&](auto k) {
        const auto density_kernel = [&](double q) { return k.value(q); };
        // The published pair takes its gradient from another kernel than its density; the ground follows suit.
        const auto gradient_kernel = [&](double q) {
            if (kernel.choice == KernelChoice::poly6_spiky) return kernels::Spiky::value(q);
            return k.value(q);
        };
        // Share at distance d: what lies beyond the plane. Integrated downwards from d = r with plane integrals.
        const double step = 2.0 / (node_count - 1);
        double share = 0;
        for (int i = node_count - 1; i >= 0; --i) {
            const double q = -1 + i * step;
            if (i < node_count - 1) {
                constexpr int parts = 4;
                for (int part = 0; part < parts; ++part) {
                    const double middle = std::abs(q + (part + 0.5) * step / parts);
                    share += plane_integral(density_kernel, middle) * step / parts;
                }
            }
            nodes_[static_cast<std::size_t>(i)] = {
                share, -plane_integral(gradient_kernel, std::min(1.0, std::abs(q))) / kernel.support_radius};
        }
        nodes_[node_count] = nodes_[node_count - 1];

        // The continuum's share differs by some per cent from that of the lattice layers it stands for. Scale it so
        // that a rest lattice whose first layer lies half a spacing above the ground has G = 0 in that layer.
        double layers = 0;
        const double r = kernel.support_radius;
        const int reach = static_cast<int>(std::ceil(r / particle_spacing));
        for (int layer = 1; layer <= reach; ++layer) {
            for (int i = -reach; i <= reach; ++i) {
                for (int j = -reach; j <= reach; ++j) {
                    const double q = particle_spacing * std::sqrt(double(i * i + j * j + layer * layer)) / r;
                    if (q < 1) layers += kernel.particle_volume * k.value(q) / (r * r * r);
                }
            }
        }
        const double scale = layers / at(particle_spacing / 2).density;
        for (Node& node : nodes_) {
            node.density *= scale;
            node.slope *= scale;
        }
    });
    tabulate_by_slope();
}

void BoundaryTable::tabulate_by_slope() {
    const double steepest = -at(0.0).slope;
    inverse_slope_step_ = (node_count - 1) / steepest;
    for (int i = 0; i < node_count; ++i) {
        const double slope = i / inverse_slope_step_;
        double near = 0, far = support_radius_;  // the slope falls with the distance
        for (int bisection = 0; bisection < 50; ++bisection) {
            const double middle = (near + far) / 2;
            (-at(middle).slope > slope ? near : far) = middle;
        }
        by_slope_.push_back(at(far).density);
    }
    by_slope_.push_back(by_slope_.back());
}

}  // namespace talus
