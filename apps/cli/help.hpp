#pragma once

namespace talus {

// What --help of a command says after its options.

inline constexpr const char* program_help = R"(
Examples:
  talus run                                 the built-in scene, into talus_out/sham_tseng
  talus run my_scene.toml -o result         your scene, into the folder result
  talus run my_scene.toml --set material.friction_coefficient=0.3
  talus run my_scene.toml --convergence     do results hold with finer numerics? four runs, about nine times as long
  talus run my_scene.toml --vary material.friction_coefficient=0.3,0.5 --vary solver.target_particle_count=3000
                                            how much results hang on an input: a run per value, one at a time
  talus scene new --dem dem.tif --release scar.geojson --thickness-m 1.5 -o my_scene
                                            a commented scene from your own terrain, ready to run
  talus scene check my_scene/scene.toml     what a scene reads and means, without running it
  talus replay session.json                 runs a saved live session again and compares its result
  talus validate --quick                    computes cases whose results are known, and prints one table
  talus serve                               the built-in scene live in the browser: watch, steer and share it
  talus calibrate my_scene.toml --vary material.friction_coefficient=0.1:0.6
                                            which friction explains what was observed in the field, and how surely
  talus bench                               how fast talus is here: milliseconds per stage, particles per second

Exit codes:
    0  complete
    1  the machine failed: disk full, out of memory
    2  bad input: command line, scene or a file it names; nothing was written
    3  a step could not be trusted (fault); what was computed until then is written, marked partial
    4  talus validate: a case failed
  130  interrupted by Ctrl-C; what was computed until then is written, marked partial.
       A second Ctrl-C ends at once and leaves nothing. With --convergence or --vary: runs that are missing are named.)";

inline constexpr const char* run_help = R"(
Every value of the scene can be set with --set section.key=value. The result folder holds maps (GeoTIFF with QGIS
styles), front.csv, timeseries.csv, buildings.csv, results.gpkg, manifest.json and report.html.

--convergence and --vary compare front velocity at every observation, arrival (first building hit; where none is, the
front at 90 % of its way) and run-out with the scene as given: on the terminal, in convergence.csv and variants.csv, in
the report, the manifest and --json. --convergence passes where nothing changes by more than 5 %.
)";

inline constexpr const char* replay_help = R"(
A journal is what a live session can save (the page's menu, or GET /api/scenarios/A/journal): the scene, and everything
that people did with the step before which they did it. The same actions at the same steps give the same result, to the
last bit, on any number of threads.

Exit codes:
    0  the same result: the hash of the last step is that of the session
    1  the machine failed: out of memory
    2  bad input: the journal, its scene or a file it names
    3  the result is another
  130  interrupted by Ctrl-C
)";

inline constexpr const char* validate_help = R"(
A case is a folder with a case.toml: what to compute, what to expect of it, and who says so. Without CASE all cases that
travel inside the program are computed. The table shows every expectation; a failing one as FAIL, one that its case file
announces as FAIL (known). Cases whose data are not here are listed as skipped.

Exit codes:
    0  every expectation holds (with --known: all but the announced ones)
    1  the machine failed: disk full, out of memory
    2  bad input: command line or a case file; nothing was computed
    4  an expectation does not hold
  130  interrupted by Ctrl-C; the table shows the cases that were complete
)";

inline constexpr const char* serve_help = R"(
Opens the scene as a live twin in the browser: press Run in the page, change parameters, releases, barriers and buildings
while debris moves, look at every moment again, compare two scenarios, take maps and report away. It prints two links.
Who has the first can steer (one at a time), who has the second can look; both carry a secret, so pass on the right one.
Ctrl-C ends it.

Only this computer can reach it. To share it in a network, let it listen on all addresses and name those by which
browsers will know it; connections are not encrypted, so put a web server with TLS before it where that matters:
  talus serve my_scene.toml --host 0.0.0.0 --allow-host twin.example.org

The page's whole interface is open to programs: docs/protocol.md, or /api/openapi.json of the running server.
  talus serve my_scene.toml --run --json
  curl -H "Authorization: Bearer TOKEN" http://127.0.0.1:8123/api/scenarios/A/state

Exit codes:
    0  ended by Ctrl-C
    1  the machine failed: port in use, out of memory
    2  bad input: command line, scene or a file it names
  130  ended at once by a second Ctrl-C
)";

inline constexpr const char* ensemble_help = R"(
Runs the scene once per point of a design over the factors, several runs side by side, and counts: probability and
percentile maps, run-out, odds of every building, sensitivity; with a report. A factor is any value of a scene:
  --vary material.friction_coefficient=0.2:0.5        uniform between
  --vary release.volume_m3=log:300:1200               log-uniform
  --vary material.viscosity=normal:0.1:0.02           normal, cut to what the key allows; or normal:MEAN:DEV:LOW:HIGH
  --vary release.volume_m3=triangular:400:600:900     low, mode, high
  --vary solver.kernel=spiky,cubic_spline             one of a list
or [[factor]] in a plan file (docs/ensembles.md). Designs:
  latin_hypercube, monte_carlo, sobol   --runs points; percentiles and rank correlation
  grid                                  every combination of --levels values per factor, or of a list's entries
  saltelli                              first-order and total Sobol indices; factors + 2 runs per block
  morris                                elementary effects; factors + 1 runs per trajectory
Run 17 is the same on any machine: the same command again goes on where an earlier one stopped, mpirun -n N spreads runs
over ranks, and --shard i/n with talus ensemble merge does so without MPI, with the same results.

Exit codes: as talus run. A run that fails is listed with its fault, and the ensemble goes on; 3: no run was complete.
)";

inline constexpr const char* bench_help = R"(
Steps standard scenes with a fixed number of iterations and everything that a run has: terrain, friction, viscosity,
houses, maps, front and impact. Scenes:
  slab         ten layers of debris that slide down a plane of raster terrain towards two houses
  column       a block of debris, at most 24 layers high, that collapses on flat ground beside a house
  sham_tseng   600 m3 on the scar of the built-in scene, with its terrain, houses and flow path
The debris of slab and column grows with the number of particles, that of sham_tseng gets finer.
Methods: stress (the default of a scene) and pair (the published friction per pair of particles).

A row of the table is the median of the repeats:
  ms/step      wall time of a step, observers included; the second table has the share of each stage in it, in %
  ns/p-it      wall time per particle and iteration: ms/step over particles times iterations
  Mp-it/s      particle-iterations per second, in millions
  x real time  simulated seconds per second; the time step is chosen as in a run of the scene
  neighbours   mean number of neighbours of a particle
  relative     particle-iterations per unit of a calibration loop that is timed before and after every repeat: it
               changes with the program, and hardly with how busy the machine is
  hash         of the state after the last step: the same for any number of threads

Examples:
  talus bench --scene slab --particles 20000 --threads 1,2
  talus bench --full --json bench.json      up to a million particles, some minutes and 2 GB of memory

Exit codes:
    0  complete
    1  the machine failed: disk full, out of memory
    2  bad input: nothing was computed
    3  a step could not be trusted; nothing was written
  130  interrupted by Ctrl-C; the table shows what was complete, no file was written
)";

}  // namespace talus
