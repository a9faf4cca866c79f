#include "sim/physics/kernel.hpp"

namespace talus {

Kernel make_kernel(KernelChoice choice, double particle_spacing, double support_radius) {
    return with_kernel(choice, [&](auto kernel) {
        const double r = support_radius, r3 = r * r * r, r5 = r3 * r * r;
        const int reach = static_cast<int>(std::ceil(r / particle_spacing));
        double sum = 0, gradient_square = 0;
        for (int i = -reach; i <= reach; ++i) {
            for (int j = -reach; j <= reach; ++j) {
                for (int k = -reach; k <= reach; ++k) {
                    const double distance = particle_spacing * std::sqrt(double(i * i + j * j + k * k));
                    if (distance >= r) continue;
                    sum += kernel.value(distance / r) / r3;
                    if (i == 0 && j == 0 && k == 0) continue;
                    const double gradient = kernel.slope_over_q(distance / r) * distance / r5;
                    gradient_square += gradient * gradient;
                }
            }
        }
        Kernel result;
        result.choice = choice;
        result.support_radius = r;
        result.particle_volume = 1 / sum;
        result.rest_gradient_sum = gradient_square * result.particle_volume * result.particle_volume;
        // Integral of x^2 W dV = 4 pi / 3 * integral of R^4 W dR, by the midpoint rule.
        const int steps = 2000;
        double moment = 0;
        for (int i = 0; i < steps; ++i) {
            const double q = (i + 0.5) / steps;
            moment += q * q * q * q * kernel.value(q) / steps;
        }
        result.second_moment = 4 * std::numbers::pi / 3 * moment * r * r;
        return result;
    });
}

}  // namespace talus
