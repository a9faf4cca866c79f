#pragma once

#include "core/result.hpp"

namespace talus::cli {

/// The processes of one `mpirun`, which share a file system. A single one if the program was started or built without
/// MPI. Create it once, before threads start.
class Ranks {
  public:
    Ranks();
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] bool first() const { return rank_ == 0; }

    /// Broadcasts the value of the first rank.
    [[nodiscard]] bool hear_first(bool word) const;
    /// Waits for all ranks; returns the sum of their numbers.
    [[nodiscard]] long sum(long number) const;

    /// Why several ranks would not work: started by mpirun, but built without MPI.
    [[nodiscard]] static Status check();

  private:
    int rank_ = 0, count_ = 1;
};

}  // namespace talus::cli
