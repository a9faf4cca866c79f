#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "core/geometry.hpp"
#include "core/result.hpp"
#include "sim/state.hpp"

namespace talus::products {

/// A particle in a file.
struct StoredParticle {
    LocalPoint position;
    float speed = 0;  ///< m/s
    std::uint32_t id = 0;
};

/// The particles of a run's frames, kept in a file until they are written in their format.
class ParticleFrames {
  public:
    explicit ParticleFrames(std::filesystem::path file) : file_(std::move(file)) {}
    /// Deletes the file.
    ~ParticleFrames();
    ParticleFrames(const ParticleFrames&) = delete;
    ParticleFrames& operator=(const ParticleFrames&) = delete;

    [[nodiscard]] Status add(const sim::State& state);
    [[nodiscard]] std::size_t frames() const { return counts_.size(); }
    [[nodiscard]] std::size_t count(std::size_t frame) const { return counts_[frame]; }
    [[nodiscard]] Result<std::vector<StoredParticle>> read(std::size_t frame) const;

  private:
    [[nodiscard]] Error failure(const char* what) const;

    std::filesystem::path file_;
    std::FILE* stream_ = nullptr;
    std::vector<std::size_t> counts_;
};

}  // namespace talus::products
