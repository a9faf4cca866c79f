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

namespace talus::web {
namespace {

std::optional<double> latitude;

}  // namespace

void set_latitude(std::optional<double> degrees) {
    latitude = degrees;
}

}  // namespace talus::web

namespace talus::geo {

std::optional<double> latitude_deg(const Crs& /*crs*/, const PlanPoint& /*p*/) {
    return web::latitude;
}

}  // namespace talus::geo

namespace talus::sim::device {

std::unique_ptr<Backend> make_host_backend() {
    throw DeviceFailure("a page has no kernels of a card; solver.backend = \"cpu\" gives the same result");
}

}  // namespace talus::sim::device

namespace talus::observe::device {

std::unique_ptr<Particles> make_particles(sim::device::Backend& /*backend*/) {
    return nullptr;
}

}  // namespace talus::observe::device

extern "C" ssize_t getrandom(void* buffer, size_t size, unsigned /*flags*/) {
    constexpr std::size_t most = 256;  // of getentropy
    const std::size_t part = std::min(size, most);
    return getentropy(buffer, part) == 0 ? static_cast<ssize_t>(part) : -1;
}
