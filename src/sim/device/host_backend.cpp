#include "sim/device/backend_on.hpp"
#include "sim/device/host_executor.hpp"

namespace talus::sim::device {

std::unique_ptr<Backend> make_host_backend() {
    return std::make_unique<BackendOn<HostExecutor>>();
}

}  // namespace talus::sim::device
