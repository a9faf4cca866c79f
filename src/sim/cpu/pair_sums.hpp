#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/geometry.hpp"
#include "sim/physics/kernel.hpp"
#include "sim/physics/stress.hpp"
#include "sim/state.hpp"

namespace talus::cpu {

/// A kernel's constants as every pair needs them: V W = value_scale * W r^3, V grad W = -gradient_scale * slope_over_q
/// x.
struct PairScale {
    float inverse_radius, value_scale, gradient_scale;

    explicit PairScale(const Kernel& kernel) {
        const double r = kernel.support_radius;
        inverse_radius = static_cast<float>(1 / r);
        value_scale = static_cast<float>(kernel.particle_volume / (r * r * r));
        gradient_scale = static_cast<float>(kernel.particle_volume / (r * r * r * r * r));
    }
};

/// Numbers of all particles packed by fours, 16 bytes a particle: a neighbour's four lie in one cache line and are
/// loaded at once, which is several times faster than a gather from each of four arrays.
using Packed = std::vector<std::array<float, 4>>;

/// Three coordinate arrays to read from.
struct Coordinates {
    const float *x, *y, *z;
};

/// One particle's neighbours, and where V grad W of each pair is kept from one sum to the next. The arrays go on to the
/// next multiple of `padding` with the particle itself, which is at distance zero and so adds nothing but density.
struct PairList {
    static constexpr std::size_t padding = VectorArray::padding;

    const std::uint32_t* neighbour;
    std::size_t count;
    float *gradient_x, *gradient_y, *gradient_z;
};

struct DensitySums {
    float density = 0;     ///< sum of V W, the particle itself included
    float square = 0;      ///< sum of |V grad W|^2
    Vec3<float> gradient;  ///< sum of V grad W
    float divergence = 0;  ///< sum of (u_j - u_i) . V grad W
};

/// The sums over one particle's neighbours, which are where nearly all the time goes: one source for all instruction
/// sets (pair_sums.cpp), chosen once. Lanes are added up in an order that the instruction set decides: results are
/// the same on any number of threads, and differ by rounding between instruction sets.
struct PairSums {
    /// Density and pair gradients at given points; the other sums are left out.
    DensitySums (*density)(const PairScale&, const PairList&, const Packed& points, std::size_t i);
    /// All sums at given points, for given displacements.
    DensitySums (*density_and_divergence)(const PairScale&, const PairList&, const Packed& points,
                                          const Packed& displacements, std::size_t i);
    /// Sum of (u_j - u_i) (x) V grad W along the kept pair gradients.
    DisplacementGradient<float> (*deformation)(const PairList&, const Packed& displacements, std::size_t i);
    /// Sum of (T_i + T_j) V grad W along the kept pair gradients, T = d lambda I + ds. `stress_rows`: xx, xy, xz, yy;
    /// `stress_rest`: yz, zz.
    Vec3<float> (*stress_correction)(const PairList&, const Packed& stress_rows, const Packed& stress_rest,
                                     std::size_t i);
    /// Sum of (w_i + w_j) V grad W along the kept pair gradients, w being the fourth of the packed numbers.
    Vec3<float> (*scalar_correction)(const PairList&, const Packed& scalars, std::size_t i);
    /// The published correction: sum of (d lambda_i + d lambda_j) V grad W and of pair friction. The fourth number of a
    /// point is its d lambda; `cap` as pair_friction_cap.
    Vec3<float> (*pair_correction)(const PairScale&, const PairList&, const Packed& points, const Packed& displacements,
                                   float cap, std::size_t i);
    /// Sum of V W (v_j - v_i).
    Vec3<float> (*velocity_difference)(const PairScale&, const PairList&, const Packed& points,
                                       const Packed& velocities, std::size_t i);
    /// Writes to `found` the indices in [first, last) nearer to `p` than the root of `square_radius`, in order, and
    /// returns how many. `found` must have room for last - first and one vector more, points for one more to read.
    std::size_t (*select_near)(const Coordinates& points, std::uint32_t first, std::uint32_t last, const Vec3<float>& p,
                               float square_radius, std::uint32_t* found);
    std::string_view instruction_set;  ///< "AVX3", "AVX2", "SSE4", ...
};

/// The sums for a kernel on the best instruction set of this processor, or on that which the environment variable
/// TALUS_SIMD names (an unknown or unavailable name is ignored).
[[nodiscard]] PairSums pair_sums_for(KernelChoice kernel);

}  // namespace talus::cpu
