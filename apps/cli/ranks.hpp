#pragma once

#include "core/result.hpp"

namespace talus {

/// The processes of one `mpirun`, which share a file system. One alone where the program was started without, or built
/// without MPI. Make it before threads start, once.
class Ranks {
  public:
    Ranks();
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] bool first() const { return rank_ == 0; }

    /// The first rank's word for all of them.
    [[nodiscard]] bool hear_first(bool word) const;
    /// Waits until all ranks are here; the sum of their numbers.
    [[nodiscard]] long sum(long number) const;

    /// Why several ranks would not work: started by mpirun, but built without MPI.
    [[nodiscard]] static Status check();

  private:
    int rank_ = 0, count_ = 1;
};

}  // namespace talus
