#include "observe/device/particles_on.hpp"
#include "sim/device/host_executor.hpp"

namespace talus::observe::device {

std::unique_ptr<Particles> make_particles(sim::device::Backend& backend) {
    std::unique_ptr<Particles> on_host = particles_on<sim::device::HostExecutor>(backend);
    return on_host ? std::move(on_host) : make_cuda_particles(backend);
}

}  // namespace talus::observe::device
