// In place of cuda_particles.cu where there is no CUDA toolkit.
#include "observe/device/particles.hpp"

namespace talus::observe::device {

std::unique_ptr<Particles> make_cuda_particles(sim::device::Backend& /*backend*/) {
    return nullptr;
}

}  // namespace talus::observe::device
