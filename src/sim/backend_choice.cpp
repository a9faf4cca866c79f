#include "sim/backend_choice.hpp"

#include <fmt/format.h>

#include "sim/device/card.hpp"

namespace talus::sim {
namespace {

/// Below it a step has too few particles for the threads of a card, and starting its kernels takes longer than the
/// processor needs. An estimate: not measured on a card yet (docs/gpu.md).
constexpr std::uint32_t worth_a_card = 50000;

}  // namespace

Status check_backend(params::BackendChoice choice) {
    if (choice != params::BackendChoice::cuda || device::card()) return {};
    return Error{
        fmt::format("backend \"cuda\" is refused; {}: take \"cpu\", or \"auto\"", device::card().error().message)};
}

params::BackendChoice settled_backend(params::BackendChoice choice, std::uint32_t particles) {
    if (choice != params::BackendChoice::automatic) return choice;
    return particles >= worth_a_card && device::card() ? params::BackendChoice::cuda : params::BackendChoice::cpu;
}

std::string_view backend_name(params::BackendChoice choice) {
    switch (choice) {
        case params::BackendChoice::automatic:
            return "auto";
        case params::BackendChoice::cuda:
            return "cuda";
        case params::BackendChoice::host:
            return "host";
        case params::BackendChoice::cpu:
            break;
    }
    return "cpu";
}

std::string describe_backends() {
    const Result<device::Card>& card = device::card();
    if (card) return fmt::format("cpu, cuda ({}, driver for CUDA {}), host", card->name, card->driver);
    return fmt::format("cpu, host; no cuda: {}", card.error().message);
}

}  // namespace talus::sim
