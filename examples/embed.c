/*
 * A debris flow in a program of one's own: a slope with a house, from arrays; a barrier is added while debris moves.
 *
 *     cc embed.c $(pkg-config --cflags --libs talus) -lm && ./a.out
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "talus.h"

enum { columns = 120, rows = 60 };

static void check(int code, const talus_error* error) {
    if (code == TALUS_OK) return;
    fprintf(stderr, "talus: %s\n", error->text);
    exit(code);
}

/* How far a long call is; anything but 0 would end it. */
static int show(void* user, double share) {
    (void)user;
    fprintf(stderr, "\r%3.0f %%", 100 * share);
    return 0;
}

int main(void) {
    /* A hillside of 25 degrees that runs out on flat ground at x = 70 m, and a scar 1.5 m deep. */
    static float elevation[rows * columns], release[rows * columns];
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double x = column + 0.5, y = row + 0.5;
            elevation[row * columns + column] = (float)(100 + 0.466 * fmax(0, 70 - x));
            if (hypot(x - 15, y - 30) < 8) release[row * columns + column] = 1.5f;
        }
    }
    const double outline[] = {84, 26, 92, 26, 92, 34, 84, 34};
    const talus_building house = {.size = sizeof house, .name = "house", .x_y = outline, .point_count = 4, .height = 5};
    const talus_arrays arrays = {
        .size = sizeof arrays,
        .crs = "EPSG:32650",
        .grid = {.x_min = 0, .y_min = 0, .cell = 1, .columns = columns, .rows = rows},
        .elevation = elevation,
        .release = release,
        .buildings = &house,
        .building_count = 1,
    };
    const char* settings[] = {"material.friction_coefficient=0.2", "solver.target_particle_count=3000"};

    talus_error error = TALUS_SIZED(talus_error);
    talus_simulation* simulation;
    check(talus_open_arrays(&arrays, NULL, settings, 2, NULL, &simulation, &error), &error);
    check(talus_advance(simulation, 2, NULL, &error), &error);

    /* What moves, and how fast. */
    talus_debris debris = TALUS_SIZED(talus_debris);
    check(talus_get_debris(simulation, &debris, &error), &error);
    talus_state state = TALUS_SIZED(talus_state);
    check(talus_get_state(simulation, &state, &error), &error);
    double fastest = 0;
    for (size_t i = 0; i < debris.count; ++i) {
        const double speed =
            sqrt(debris.velocity_x[i] * debris.velocity_x[i] + debris.velocity_y[i] * debris.velocity_y[i] +
                 debris.velocity_z[i] * debris.velocity_z[i]);
        fastest = fmax(fastest, speed);
    }
    printf("t = %.1f s: %zu particles of %.3f m3, the fastest at %.1f m/s\n", state.time, debris.count,
           state.particle_volume, fastest);

    /* A barrier across the foot of the slope, for the last moment. */
    const char* barrier;
    check(talus_apply(simulation,
                      "{\"action\": \"put_barrier\", \"name\": \"dam\", \"line\": [[74, 12], [74, 48]],"
                      " \"height_m\": 3, \"thickness_m\": 2}",
                      &barrier, &error),
          &error);
    const talus_progress progress = {.size = sizeof progress, .call = show, .user = NULL};
    check(talus_advance(simulation, 20, &progress, &error), &error);
    fprintf(stderr, "\r");
    check(talus_get_state(simulation, &state, &error), &error);

    for (size_t k = 0; k < state.structure_count; ++k) {
        talus_structure structure = TALUS_SIZED(talus_structure);
        check(talus_get_structure(simulation, k, &structure, &error), &error);
        printf("%s: peak force %.0f kN, peak impact pressure %.0f kPa\n", structure.name, structure.peak_force / 1e3,
               structure.peak_impact_pressure / 1e3);
    }
    talus_map depth = TALUS_SIZED(talus_map);
    check(talus_get_map(simulation, "peak_depth", &depth, &error), &error);
    double deepest = 0;
    for (long k = 0; k < (long)depth.grid.columns * depth.grid.rows; ++k) {
        if (depth.values[k] > deepest) deepest = depth.values[k];
    }
    printf("deepest flow %.1f m; %s\n", deepest, state.message);
    talus_close(simulation);
    return 0;
}
