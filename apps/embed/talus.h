/*
 * talus.h - landslides and debris flows in other programs: the C interface of libtalus.
 *
 * A simulation is made from a scene file or from arrays, stepped, changed between steps, and read through pointers.
 * SI units throughout. Plan positions of what is passed in and of maps are world coordinates; debris is in local
 * single-precision metres from the origin in talus_state.
 *
 * Errors: a function that can fail returns a code, and writes a sentence into `error` unless that is NULL. Nothing is
 * changed by a call that fails. NULL where a pointer is needed is TALUS_BAD_INPUT. No exception leaves the library, and
 * it keeps no state outside a simulation, but for the two hooks, talus_set_log() and talus_set_allocator().
 *
 * Threads: a simulation is used by one thread at a time; several simulations can be used at once. A step computes on
 * the threads of solver.thread_count (default: all cores); results do not depend on their number.
 *
 * Pointers: all that is returned, texts as well as arrays, belongs to the simulation and remains valid until the next
 * call that takes it without const. Reading takes it with const: it leaves everything valid.
 *
 * Sizes: `size` of a struct is sizeof that struct, set by the caller before every use: TALUS_SIZED does it. A struct
 * that is smaller than that of this version is refused; of a larger one only what this version has is read and written.
 */
#ifndef TALUS_H
#define TALUS_H

#include <stddef.h>
#include <stdint.h>

/*
 * Semantic versioning. While the major version is 0, a new minor version may break programs: the name of the library
 * (libtalus.so.0.1) and the version of its symbols (TALUS_0.1) change with it.
 */
#define TALUS_VERSION_MAJOR 0
#define TALUS_VERSION_MINOR 1
#define TALUS_VERSION_PATCH 0

/* TALUS_BUILDING: in the library itself. TALUS_STATIC: in it, and in a program that it is linked into. */
#if defined(_WIN32) && !defined(TALUS_STATIC)
#ifdef TALUS_BUILDING
#define TALUS_API __declspec(dllexport)
#else
#define TALUS_API __declspec(dllimport)
#endif
#elif defined(__GNUC__) && !defined(_WIN32)
#define TALUS_API __attribute__((visibility("default")))
#else
#define TALUS_API
#endif

/* A struct with its size, and 0 in all else: talus_error error = TALUS_SIZED(talus_error); */
#ifdef __cplusplus
#define TALUS_SIZED(type) \
    { sizeof(type) }
#else
#define TALUS_SIZED(type) \
    { .size = sizeof(type) }
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct talus_simulation talus_simulation;

enum {
    TALUS_OK = 0,
    TALUS_FAILURE = 1,   /* the machine: out of memory, disk full */
    TALUS_BAD_INPUT = 2, /* an argument, the scene or a file it names */
    TALUS_FAULT = 3,     /* the last step cannot be trusted; the sentence says why */
    TALUS_CANCELLED = 4  /* by talus_progress */
};

typedef struct talus_error {
    size_t size;
    int code;
    char text[2000]; /* one sentence: file, key, value and what is allowed, where they apply */
} talus_error;

/* "0.1.0" */
TALUS_API const char* talus_version(void);

enum {
    TALUS_LOG_INFO = 0,    /* opened, changed, at rest, ended, cancelled, saved */
    TALUS_LOG_WARNING = 1, /* what was assumed about the inputs of a scene, or done to them */
    TALUS_LOG_ERROR = 2    /* the sentence of every call that fails */
};

/*
 * Where the library tells what it does: `write` is called on the thread of the call that it is about, by several
 * threads at once where several call. `sentence` is valid within it. It may call functions that read.
 */
typedef struct talus_log {
    size_t size;
    void (*write)(void* user, int level, const char* sentence);
    void* user;
    int32_t least_level; /* nothing below it is told */
} talus_log;

/* For the whole program, from now on. NULL: no log, as at the start. */
TALUS_API int talus_set_log(const talus_log* log, talus_error* error);

/*
 * Memory for the arrays that the library makes to hand them out: those of talus_get_map(), talus_get_map_on(),
 * talus_get_front(), talus_get_debris_at() and talus_get_surface(). The solver's own memory, which talus_get_debris()
 * shows, and texts are C++'s. `allocate`: NULL means that there is none left. `release` gets what `allocate` was asked
 * for; a block goes back to the allocator it came from, so `user` must last until all simulations are closed. Both are
 * called by any thread that calls the library.
 */
typedef struct talus_allocator {
    size_t size;
    void* (*allocate)(void* user, size_t bytes, size_t alignment);
    void (*release)(void* user, void* block, size_t bytes, size_t alignment);
    void* user;
} talus_allocator;

/* For the whole program, for arrays that are made from now on. NULL: that of C++, as at the start. */
TALUS_API int talus_set_allocator(const talus_allocator* allocator, talus_error* error);

/*
 * What long calls tell, and whether they go on: `call` is called on the caller's thread, at most every 20 ms, with the
 * share that is done, 0 to 1. If it returns anything but 0, the call ends with TALUS_CANCELLED: at once, or after the
 * time step that it is in. What was cancelled while it opened is not there; what was cancelled between two steps can be
 * read and goes on. `call` may read the simulation, and not change it. NULL in place of the struct: no such calls.
 */
typedef struct talus_progress {
    size_t size;
    int (*call)(void* user, double share);
    void* user;
} talus_progress;

/*
 * A scene file. `settings`: "section.key=value" as for `talus run --set`, `setting_count` of them. `scene_file` NULL:
 * the scene that the library carries inside itself. Close what was opened with talus_close().
 */
TALUS_API int talus_open(const char* scene_file, const char* const* settings, size_t setting_count,
                         const talus_progress* progress, talus_simulation** simulation, talus_error* error);

/*
 * Square cells; row 0 is the southernmost, column 0 the westernmost, rows follow one another. Part of other structs: it
 * gets no more members.
 */
typedef struct talus_grid {
    double x_min, y_min; /* west and south edge, m */
    double cell;         /* m */
    int32_t columns, rows;
} talus_grid;

/* A building: `x_y` has `point_count` corners in the order of its outline, x before y. */
typedef struct talus_building {
    size_t size;      /* the same in all of an array */
    const char* name; /* NULL: "building 1", ... */
    const double* x_y;
    size_t point_count;
    double height; /* m above the mean ground of the outline: above 0 to 1000 */
} talus_building;

typedef struct talus_arrays {
    size_t size;
    const char* crs; /* projected and metric: "EPSG:2326", or WKT; "local": metres of its own, as those of a flume */
    talus_grid grid;
    const float* elevation;          /* m; NaN: not known */
    const float* release;            /* m, vertical thickness of the debris that fails, part of `elevation`; 0: none */
    const talus_building* buildings; /* NULL: none */
    size_t building_count;
} talus_arrays;

/*
 * A scene from arrays. `folder`: a new or empty one that the scene is written into, as files that `talus run` and
 * talus_open() read; NULL: none is kept. The rest as talus_open(): material, solver and outputs are settings.
 */
TALUS_API int talus_open_arrays(const talus_arrays* arrays, const char* folder, const char* const* settings,
                                size_t setting_count, const talus_progress* progress, talus_simulation** simulation,
                                talus_error* error);

/* Frees a simulation. NULL: does nothing, as free(). */
TALUS_API void talus_close(talus_simulation* simulation);

/*
 * Takes `steps` time steps, fewer if the run is over before: see talus_state. The time step adapts to the flow, unless
 * solver.time_step_s is given.
 */
TALUS_API int talus_step(talus_simulation* simulation, uint64_t steps, const talus_progress* progress,
                         talus_error* error);

/*
 * Takes steps until `time`, s, is reached or the run is over. `time`: a number, 0 or more; INFINITY: until it is over.
 * The last step is not cut short: results do not depend on when somebody looks. See talus_get_debris_at().
 */
TALUS_API int talus_advance(talus_simulation* simulation, double time, const talus_progress* progress,
                            talus_error* error);

enum {
    TALUS_READY = 0,
    TALUS_AT_REST = 1, /* what still moves changes no result; a change may make it ready again */
    TALUS_ENDED = 2,   /* solver.end_time_s is reached, or no debris is left */
    TALUS_STOPPED = 3  /* a step could not be trusted */
};

typedef struct talus_state {
    size_t size;
    int32_t phase;          /* TALUS_READY, ... */
    const char* message;    /* why it is at rest, ended or stopped; "" while ready */
    double time;            /* s */
    uint64_t steps;         /* taken so far */
    double origin[3];       /* world position of the local frame: x, y, z */
    double particle_volume; /* m3 */
    uint64_t structure_count;
} talus_state;

TALUS_API int talus_get_state(const talus_simulation* simulation, talus_state* state, talus_error* error);

/* Of time, positions and velocities: equal for equal results, on any number of threads and any instruction set. */
TALUS_API int talus_get_hash(const talus_simulation* simulation, uint64_t* hash, talus_error* error);

/* `count` particles in an order that changes with every step; `id` names a particle for good. */
typedef struct talus_debris {
    size_t size;
    size_t count;
    const float *x, *y, *z;                            /* m, local */
    const float *velocity_x, *velocity_y, *velocity_z; /* m/s */
    const uint32_t* id;
    const uint8_t* held; /* 1: its release has not started */
} talus_debris;

TALUS_API int talus_get_debris(const talus_simulation* simulation, talus_debris* debris, talus_error* error);

/*
 * The debris at exactly `time`, s, in the last step of talus_advance() to this or an earlier time: `time` is at or
 * before talus_state's, and at or after that before the step. Positions and velocities lie on straight lines between
 * the two; particles that came in with the step are moved back along their velocity. If the run is over, also later:
 * debris as it lies. Changes nothing: results are those of steps alone. talus_step() and changes forget what was
 * before.
 */
TALUS_API int talus_get_debris_at(const talus_simulation* simulation, double time, talus_debris* debris,
                                  talus_error* error);

typedef struct talus_map {
    size_t size;
    talus_grid grid;
    const float* values; /* NaN: no value */
} talus_map;

/*
 * "depth" (m, now), "speed" (m/s, now, averaged over the depth; 0 where debris is too thin to have one), "peak_depth"
 * (m), "peak_speed" (m/s), "peak_pressure" (Pa, density times speed squared), "arrival_time" (s), "deposit_depth" (m),
 * "erosion_depth" (m). Its extent follows the debris.
 */
TALUS_API int talus_get_map(const talus_simulation* simulation, const char* name, talus_map* map, talus_error* error);

/*
 * The same on cells of the caller's, always as many: 1 to 1048576 columns and rows, at most 400 million cells. A cell
 * that holds centres of the map's cells (outputs.map_cell_m) has the mean of their depths (0 without debris), the
 * largest of their peaks and speeds, or their first arrival; a smaller one has the value of the cell that its centre
 * lies in.
 */
TALUS_API int talus_get_map_on(const talus_simulation* simulation, const char* name, const talus_grid* grid,
                               talus_map* map, talus_error* error);

/* Elevation of the ground now, m, as entrainment has left it, at a world plan position. Refuses one off the terrain. */
TALUS_API int talus_get_elevation(const talus_simulation* simulation, double x, double y, double* elevation,
                                  talus_error* error);

/*
 * The same at `count` positions at once, x before y, into `elevations` of the caller's: NaN off the terrain. At most a
 * hundred million.
 */
TALUS_API int talus_get_elevations(const talus_simulation* simulation, const double* x_y, size_t count,
                                   double* elevations, talus_error* error);

/*
 * The surface of the debris now: a vertex at the centre of each map cell with debris and of those around, where it
 * meets the ground. Triangles are counterclockwise from above.
 */
typedef struct talus_surface {
    size_t size;
    size_t vertex_count;
    const float* positions; /* m, local, x y z of each vertex */
    const float* normals;   /* unit, likewise */
    const float* depth;     /* m, one per vertex; 0 where it meets the ground */
    const float* speed;     /* m/s, one per vertex */
    size_t index_count;
    const uint32_t* indices; /* three vertices of each triangle */
} talus_surface;

TALUS_API int talus_get_surface(const talus_simulation* simulation, talus_surface* surface, talus_error* error);

/* The front along the flow path: `count` chainages that it has passed. NaN: no value. */
typedef struct talus_front {
    size_t size;
    size_t count;
    const double* chainage;     /* m */
    const double* arrival_time; /* s */
    const double* velocity;     /* m/s */
} talus_front;

TALUS_API int talus_get_front(const talus_simulation* simulation, talus_front* front, talus_error* error);

/* A building or barrier, in the order in which they were added; removed ones keep their place. */
typedef struct talus_structure {
    size_t size;
    const char* name;
    int32_t hit, is_barrier;
    double first_hit_time;       /* s; NaN: not hit, or not failed */
    double failure_time;         /* s */
    double peak_force;           /* N, on all its walls, filtered over outputs.impact_filter_window_s */
    double peak_impact_pressure; /* Pa, of a patch of outputs.impact_patch_edge_m squared, filtered likewise */
    double peak_depth;           /* m, of the flow in front of its walls */
    double impulse;              /* N s */
} talus_structure;

/* `index`: less than structure_count of talus_state. */
TALUS_API int talus_get_structure(const talus_simulation* simulation, size_t index, talus_structure* structure,
                                  talus_error* error);

/* A live key of the scene reference between two steps: "material.friction_coefficient". */
TALUS_API int talus_set(talus_simulation* simulation, const char* key, double value, talus_error* error);

/*
 * Any action of docs/protocol.md on releases, inflows, buildings, barriers, zones, beds and material, as JSON:
 * {"action": "put_barrier", "line": [[x, y], [x, y]], "height_m": 4}. `created`: the id of what is new, or ""; NULL:
 * not wanted.
 */
TALUS_API int talus_apply(talus_simulation* simulation, const char* action, const char** created, talus_error* error);

/*
 * "scene", "state", "setup", "impacts" or "series" as JSON, as docs/protocol.md has them; "verdict": whether the
 * results so far can be relied on, as `verdict` of docs/results.md; "results": what a report of the run so far shows, as
 * results.json of docs/results.md; "measures": {"run_out": {"run_out_along_flow_m", "run_out_straight_m",
 * "run_out_at_least" (debris left the terrain), "toe_x_m", "toe_y_m", "drop_m", "runout_angle_deg", "travel_angle_deg",
 * "front_chainage_m"}, "gauges": [{"name", "x_m", "y_m", "time_s": [...], "depth_m": [...], "speed_mps": [...]}],
 * "crs_wkt"}, with null where there is no value.
 */
TALUS_API int talus_get_json(const talus_simulation* simulation, const char* name, const char** json,
                             talus_error* error);

/* Writes maps, tables and report of the run so far, as `talus run` does, into a new or empty folder. */
TALUS_API int talus_write_results(const talus_simulation* simulation, const char* folder, talus_error* error);

/*
 * Saves what determines the state: the scene's name and all changes with the step before which they were made.
 * talus_open_saved() computes the same state again, to the bit; it takes as long as the steps did. A scene from arrays
 * needs a folder of its own for this. A saved simulation is a file of at most 64 MiB.
 */
TALUS_API int talus_save(const talus_simulation* simulation, const char* file, talus_error* error);
TALUS_API int talus_open_saved(const char* file, const talus_progress* progress, talus_simulation** simulation,
                               talus_error* error);

/*
 * A second simulation in the present state of the first, with all that was measured: in the time that copying its
 * memory takes. Both go on by themselves, to the same bits until one is changed; each is closed.
 */
TALUS_API int talus_fork(const talus_simulation* simulation, talus_simulation** fork, talus_error* error);

/* The state of a simulation, kept in memory. Used by one thread at a time; it may outlast the simulation. */
typedef struct talus_snapshot talus_snapshot;

TALUS_API int talus_take_snapshot(const talus_simulation* simulation, talus_snapshot** snapshot, talus_error* error);

/* Brings a simulation, or a fork of it, back to a snapshot: as often as wanted, also forwards. */
TALUS_API int talus_restore(talus_simulation* simulation, const talus_snapshot* snapshot, talus_error* error);

/* Frees a snapshot. NULL: does nothing, as free(). */
TALUS_API void talus_drop_snapshot(talus_snapshot* snapshot);

#ifdef __cplusplus
}
#endif

#endif
