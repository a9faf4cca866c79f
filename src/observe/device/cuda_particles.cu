// The observers' kernels for a graphics card.
#include "observe/device/particles_on.hpp"
#include "sim/device/cuda_executor.cuh"

namespace talus::observe::device {

std::unique_ptr<Particles> make_cuda_particles(sim::device::Backend& backend) {
    return particles_on<sim::device::CudaExecutor>(backend);
}

}  // namespace talus::observe::device
