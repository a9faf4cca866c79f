// The kernels for a graphics card, and the card itself.
#include "sim/device/backend_on.hpp"
#include "sim/device/card.hpp"
#include "sim/device/cuda_executor.cuh"

namespace talus::sim::device {
namespace {

std::string version_text(int version) {
    return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

Result<Card> look_for_card() {
    int driver = 0, count = 0;
    if (cudaDriverGetVersion(&driver) != cudaSuccess || driver == 0) {
        return Error{"no driver for graphics cards of NVIDIA is installed"};
    }
    const cudaError_t status = cudaGetDeviceCount(&count);
    (void)cudaGetLastError();
    if (status == cudaErrorInsufficientDriver) {
        return Error{"the driver of the graphics card knows CUDA " + version_text(driver) + ", and talus needs " +
                     version_text(CUDART_VERSION)};
    }
    if (status != cudaSuccess || count == 0) {
        return Error{"the driver shows no graphics card" +
                     (status == cudaSuccess ? "" : std::string(" (") + cudaGetErrorString(status) + ")")};
    }
    cudaDeviceProp properties{};
    if (const cudaError_t known = cudaGetDeviceProperties(&properties, 0); known != cudaSuccess) {
        return Error{std::string("the graphics card does not answer (") + cudaGetErrorString(known) + ")"};
    }
    constexpr int oldest = 8;
    if (properties.major < oldest) {
        return Error{std::string(properties.name) + " has compute capability " + std::to_string(properties.major) +
                     "." + std::to_string(properties.minor) + ", and talus needs 8.0"};
    }
    return Card{properties.name, version_text(driver)};
}

}  // namespace

const Result<Card>& card() {
    static const Result<Card> found = look_for_card();
    return found;
}

bool built_with_cuda() {
    return true;
}

std::unique_ptr<Backend> make_cuda_backend() {
    return std::make_unique<BackendOn<CudaExecutor>>();
}

}  // namespace talus::sim::device
