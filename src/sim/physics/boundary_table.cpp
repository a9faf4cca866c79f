#include "sim/physics/boundary_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace talus::sim {
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
    : support_radius_(kernel.support_radius), inverse_step_((node_count - 1) / (2 * kernel.support_radius)) {
    struct Node {
        double density, slope;
    };
    std::vector<Node> nodes(node_count);
    with_kernel(kernel.choice, [&](auto k) {
        const auto density_kernel = [&](double q) { return k.value(q); };
        // The pair poly6_spiky takes its gradient and its density from different kernels; so does the ground.
        const auto gradient_kernel = [&](double q) {
            if (kernel.choice == params::KernelChoice::poly6_spiky) return kernels::Spiky::value(q);
            return k.value(q);
        };
        // Share at distance d: the part beyond the plane. Integrated downwards from d = r with plane integrals.
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
            nodes[static_cast<std::size_t>(i)] = {
                share, -plane_integral(gradient_kernel, std::min(1.0, std::abs(q))) / kernel.support_radius};
        }
        // In fours, which are loaded together; the last node has no next one to rise to.
        const auto tabulate = [&](double scale) {
            nodes_.clear();
            for (int i = 0; i < node_count; ++i) {
                const Node &a = nodes[static_cast<std::size_t>(i)],
                           &b = nodes[static_cast<std::size_t>(std::min(i + 1, node_count - 1))];
                nodes_.push_back({float(scale * a.density), float(scale * (b.density - a.density)),
                                  float(scale * a.slope), float(scale * (b.slope - a.slope))});
            }
        };
        tabulate(1);

        // The continuum's share differs by a few per cent from that of the lattice layers it stands for. Scale it so
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
        tabulate(layers / at(particle_spacing / 2).density);
    });
    tabulate_by_slope();
    tabulate_sticking(kernel, particle_spacing);
}

void BoundaryTable::tabulate_sticking(const Kernel& kernel, double particle_spacing) {
    const double step = 1 / (2 * inverse_step_), least_distance = particle_spacing / 4;
    std::vector<double> values(node_count);
    // The first moment of the part beyond d is the integral of the share from d to infinity.
    double moment = 0;
    for (int i = node_count - 1; i >= 0; --i) {
        const double d = i * step;
        if (i < node_count - 1) moment += step * (at(d).density + at(d + step).density) / 2;
        values[static_cast<std::size_t>(i)] = at(d).density + moment / std::max(d, least_distance);
    }
    const auto tabulate = [&](double scale) {
        sticking_.clear();
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double next = i + 1 < values.size() ? values[i + 1] : values[i];
            sticking_.push_back({float(scale * values[i]), float(scale * (next - values[i])), 0, 0});
        }
    };
    tabulate(1);
    // The loss of a rest lattice in uniform shear to the ground, sum of d times the loss over its layers, must equal
    // what a plane inside the lattice transmits: half the second moment of the kernel. The continuum's integral is a
    // fifth less.
    double taken = 0;
    for (double d = particle_spacing / 2; d < support_radius_; d += particle_spacing) taken += d * sticking_at(d);
    tabulate(kernel.second_moment / (2 * particle_spacing * taken));
}

void BoundaryTable::tabulate_by_slope() {
    const double steepest = -at(0.0).slope;
    inverse_slope_step_ = (node_count - 1) / steepest;
    std::vector<double> density;
    for (int i = 0; i < node_count; ++i) {
        const double slope = i / inverse_slope_step_;
        double near = 0, far = support_radius_;  // the slope falls with the distance
        for (int bisection = 0; bisection < 50; ++bisection) {
            const double middle = (near + far) / 2;
            (-at(middle).slope > slope ? near : far) = middle;
        }
        density.push_back(at(far).density);
    }
    for (std::size_t i = 0; i < density.size(); ++i) {
        const double next = i + 1 < density.size() ? density[i + 1] : density[i];
        by_slope_.push_back({float(density[i]), float(next - density[i]), 0, 0});
    }
}

}  // namespace talus::sim
