// In place of cuda_backend.cu where there is no CUDA toolkit.
#include "sim/device/backend.hpp"
#include "sim/device/card.hpp"

namespace talus::sim::device {

const Result<Card>& card() {
    static const Result<Card> none = Error{"this talus was built without a CUDA toolkit"};
    return none;
}

bool built_with_cuda() {
    return false;
}

std::unique_ptr<Backend> make_cuda_backend() {
    throw DeviceFailure(card().error().message);
}

}  // namespace talus::sim::device
