#include "ranks.hpp"

#include <cstdlib>
#include <string_view>

#ifdef TALUS_WITH_MPI
#include <mpi.h>
#endif

namespace talus::cli {
namespace {

/// Whether a launcher of MPI (OpenMPI, MPICH, Slurm's PMI) started this process among several.
bool launched() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) {
        const char* value = std::getenv(name);
        if (value != nullptr && std::string_view(value) != "1") return true;
    }
    return false;
}

}  // namespace

#ifdef TALUS_WITH_MPI

Ranks::Ranks() {
    if (!launched()) return;  // starting MPI takes a second that a single run can save
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
}

Ranks::~Ranks() {
    int running = 0;
    MPI_Initialized(&running);
    if (running != 0) MPI_Finalize();
}

bool Ranks::hear_first(bool word) const {
    int heard = word ? 1 : 0;
    if (count_ > 1) MPI_Bcast(&heard, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return heard != 0;
}

long Ranks::sum(long number) const {
    long all = number;
    if (count_ > 1) MPI_Allreduce(&number, &all, 1, MPI_LONG, MPI_SUM, MPI_COMM_WORLD);
    return all;
}

Status Ranks::check() {
    return {};
}

#else

Ranks::Ranks() = default;
Ranks::~Ranks() = default;

bool Ranks::hear_first(bool word) const {
    return word;
}

long Ranks::sum(long number) const {
    return number;
}

Status Ranks::check() {
    if (!launched()) return {};
    return Error{
        "started by mpirun, but this talus was built without MPI; install OpenMPI's development files and build "
        "again, or use --shard i/n"};
}

#endif

}  // namespace talus::cli
