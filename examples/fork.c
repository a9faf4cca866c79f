/*
 * How long a fork takes: a simulation of the scene that comes with talus, forked while its debris moves.
 *
 *     cc -O2 fork.c $(pkg-config --cflags --libs talus) && ./a.out 100000
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "talus.h"

static void check(int code, const talus_error* error) {
    if (code == TALUS_OK) return;
    fprintf(stderr, "talus: %s\n", error->text);
    exit(code);
}

static double now_ms(void) {
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static int ascending(const void* a, const void* b) {
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

enum { times = 9 };

static double median(double* ms) {
    qsort(ms, times, sizeof *ms, ascending);
    return ms[times / 2];
}

int main(int argc, char** argv) {
    char particles[100];
    snprintf(particles, sizeof particles, "solver.target_particle_count=%s", argc > 1 ? argv[1] : "10000");
    const char* settings[] = {particles};
    talus_error error = TALUS_SIZED(talus_error);
    talus_simulation* simulation;
    check(talus_open(NULL, settings, 1, NULL, &simulation, &error), &error);
    check(talus_advance(simulation, 2, NULL, &error), &error);

    double fork_ms[times], snapshot_ms[times], restore_ms[times], first_ms[times], step_ms[times];
    for (int k = 0; k < times; ++k) {
        talus_simulation* fork;
        talus_snapshot* snapshot;
        const double start = now_ms();
        check(talus_fork(simulation, &fork, &error), &error);
        const double forked = now_ms();
        check(talus_take_snapshot(simulation, &snapshot, &error), &error);
        const double taken = now_ms();
        check(talus_restore(simulation, snapshot, &error), &error);
        const double restored = now_ms();
        check(talus_step(fork, 1, NULL, &error), &error);
        const double first = now_ms();
        check(talus_step(fork, 1, NULL, &error), &error);
        const double second = now_ms();
        fork_ms[k] = forked - start;
        snapshot_ms[k] = taken - forked;
        restore_ms[k] = restored - taken;
        first_ms[k] = first - restored;
        step_ms[k] = second - first;
        talus_drop_snapshot(snapshot);
        check(talus_step(simulation, 2, NULL, &error), &error);
        uint64_t here, there;
        check(talus_get_hash(simulation, &here, &error), &error);
        check(talus_get_hash(fork, &there, &error), &error);
        if (here != there) {
            fprintf(stderr, "the fork differs: %016" PRIx64 " and %016" PRIx64 "\n", here, there);
            return 1;
        }
        talus_close(fork);
    }
    talus_debris debris = TALUS_SIZED(talus_debris);
    check(talus_get_debris(simulation, &debris, &error), &error);
    printf(
        "%zu particles: fork %.1f ms, snapshot %.1f ms, restore %.1f ms, first step of a fork %.1f ms, any other %.1f "
        "ms\n",
        debris.count, median(fork_ms), median(snapshot_ms), median(restore_ms), median(first_ms), median(step_ms));
    talus_close(simulation);
    return 0;
}
