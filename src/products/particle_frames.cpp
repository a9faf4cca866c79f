#include "products/particle_frames.hpp"

#include <cerrno>
#include <cstring>
#include <numeric>
#include <system_error>

#include <fmt/format.h>

namespace talus::products {

ParticleFrames::~ParticleFrames() {
    if (stream_ == nullptr) return;
    std::fclose(stream_);
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
}

Error ParticleFrames::failure(const char* what) const {
    return Error{fmt::format("{}: cannot be {}: {}", file_.string(), what, std::strerror(errno))};
}

Status ParticleFrames::add(const sim::State& state) {
    if (stream_ == nullptr) stream_ = std::fopen(file_.c_str(), "w+b");
    if (stream_ == nullptr) return failure("made");
    std::vector<StoredParticle> particles(state.count);
    for (std::size_t i = 0; i < particles.size(); ++i) {
        particles[i] = {state.position.at(i), length(state.velocity.at(i)), state.id[i]};
    }
    if (std::fwrite(particles.data(), sizeof(StoredParticle), particles.size(), stream_) != particles.size() ||
        std::fflush(stream_) != 0) {
        return failure("written");
    }
    counts_.push_back(particles.size());
    return {};
}

Result<std::vector<StoredParticle>> ParticleFrames::read(std::size_t frame) const {
    const std::size_t before =
        std::accumulate(counts_.begin(), counts_.begin() + static_cast<std::ptrdiff_t>(frame), std::size_t{0});
    std::vector<StoredParticle> particles(counts_[frame]);
    if (fseeko(stream_, static_cast<off_t>(before * sizeof(StoredParticle)), SEEK_SET) != 0 ||
        std::fread(particles.data(), sizeof(StoredParticle), particles.size(), stream_) != particles.size()) {
        return failure("read");
    }
    return particles;
}

}  // namespace talus::products
