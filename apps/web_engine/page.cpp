#include "page.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <sys/random.h>
#include <unistd.h>

#include "geo/latitude.hpp"
#include "observe/device/particles.hpp"
#include "sim/device/backend.hpp"

/// What a page has in place of libraries and hardware of a machine.

namespace talus::web_engine {
namespace {

std::optional<double> latitude;

std::optional<double> known_latitude() {
    return latitude;
}

}  // namespace

void set_latitude(std::optional<double> degrees) {
    latitude = degrees;
}

}  // namespace talus::web_engine

std::optional<double> talus::geo::latitude_deg(const Crs& /*crs*/, const PlanPoint& /*p*/) {
    return web_engine::known_latitude();
}

std::unique_ptr<talus::sim::device::Backend> talus::sim::device::make_host_backend() {
    throw DeviceFailure("a page has no kernels of a card; solver.backend = \"cpu\" gives the same result");
}

std::unique_ptr<talus::observe::device::Particles> talus::observe::device::make_particles(
    sim::device::Backend& /*backend*/) {
    return nullptr;
}

extern "C" ssize_t getrandom(void* buffer, size_t size, unsigned /*flags*/) {
    constexpr std::size_t most = 256;  // of getentropy
    const std::size_t part = std::min(size, most);
    return getentropy(buffer, part) == 0 ? static_cast<ssize_t>(part) : -1;
}
