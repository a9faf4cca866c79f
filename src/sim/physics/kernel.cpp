#include "sim/physics/kernel.hpp"

#include <algorithm>
#include <vector>

namespace talus::sim {
namespace {

/// A multiplier that varies as cos(k x) over the lattice moves particles by the lattice sum of 2 grad W sin(k x), which
/// changes the constraints in the same pattern: the eigenvalue of a wave is the square of the sum, relative to the
/// diagonal. The largest over all waves of the lattice.
double max_lattice_eigenvalue(const std::vector<Vec3<double>>& offsets, const std::vector<Vec3<double>>& gradients,
                              double gradient_square) {
    constexpr int waves = 24;  // per axis, from 0 to pi
    double max = 0;
    for (int a = 0; a <= waves; ++a) {
        for (int b = 0; b <= a; ++b) {
            for (int c = 0; c <= b; ++c) {
                const Vec3<double> wave = Vec3<double>{double(a), double(b), double(c)} * (std::numbers::pi / waves);
                Vec3<double> sum{};
                for (std::size_t i = 0; i < offsets.size(); ++i) {
                    sum += gradients[i] * std::sin(dot(wave, offsets[i]));
                }
                max = std::max(max, dot(sum, sum) / gradient_square);
            }
        }
    }
    return max;
}

}  // namespace

Kernel make_kernel(params::KernelChoice choice, double particle_spacing, double support_radius) {
    return with_kernel(choice, [&](auto kernel) {
        const double r = support_radius, r3 = r * r * r, r5 = r3 * r * r;
        const int reach = static_cast<int>(std::ceil(r / particle_spacing));
        double sum = 0, gradient_square = 0, gradient_moment = 0, moment = 0;
        std::vector<Vec3<double>> offsets, gradients;  // offsets in spacings
        for (int i = -reach; i <= reach; ++i) {
            for (int j = -reach; j <= reach; ++j) {
                for (int k = -reach; k <= reach; ++k) {
                    const double distance = particle_spacing * std::sqrt(double(i * i + j * j + k * k));
                    if (distance >= r) continue;
                    const double value = kernel.value(distance / r) / r3, x = i * particle_spacing;
                    sum += value;
                    moment += x * x * value;
                    if (i == 0 && j == 0 && k == 0) continue;
                    const double gradient = kernel.slope_over_q(distance / r) * distance / r5;
                    gradient_square += gradient * gradient;
                    gradient_moment += x * x / distance * gradient;
                    offsets.push_back({double(i), double(j), double(k)});
                    gradients.push_back(offsets.back() * (gradient * particle_spacing / distance));
                }
            }
        }
        Kernel result;
        result.choice = choice;
        result.support_radius = r;
        result.particle_volume = 1 / sum;
        result.rest_gradient_sum = gradient_square * result.particle_volume * result.particle_volume;
        result.max_eigenvalue = max_lattice_eigenvalue(offsets, gradients, gradient_square);
        result.gradient_moment = gradient_moment * result.particle_volume;
        result.second_moment = moment * result.particle_volume;
        return result;
    });
}

}  // namespace talus::sim
