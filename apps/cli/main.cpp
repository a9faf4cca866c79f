#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <signal.h>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/measure.hpp"
#include "bench/scenes.hpp"
#include "calibrate_command.hpp"
#include "commands.hpp"
#include "exit_code.hpp"
#include "params/scene_text.hpp"
#include "scene/new_scene.hpp"

namespace talus {
namespace {

constexpr const char* program_help = R"(
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

constexpr const char* run_help = R"(
Every value of the scene can be set with --set section.key=value. The result folder holds maps (GeoTIFF with QGIS
styles), front.csv, timeseries.csv, buildings.csv, results.gpkg, manifest.json and report.html.

--convergence and --vary compare front velocity at every observation, arrival (first building hit; where none is, the
front at 90 % of its way) and run-out with the scene as given: on the terminal, in convergence.csv and variants.csv, in
the report, the manifest and --json. --convergence passes where nothing changes by more than 5 %.
)";

constexpr const char* replay_help = R"(
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

constexpr const char* validate_help = R"(
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

constexpr const char* serve_help = R"(
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

constexpr const char* ensemble_help = R"(
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

constexpr const char* bench_help = R"(
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

void add_scene_inputs(CLI::App& command, std::string& data) {
    command.add_option("--data", data, "folder that ${TALUS_DATA} in a scene's paths stands for")->type_name("DIR");
}

void add_overrides(CLI::App& command, std::vector<std::string>& overrides) {
    command.add_option("--set", overrides, "set a value of the scene; may be given many times")
        ->type_name("SECTION.KEY=VALUE")
        ->allow_extra_args(false);
}

void add_thresholds(CLI::App& command, std::string& depths, std::string& speeds, std::string& pressures) {
    command.add_option("--depth-m", depths, "peak depths to map the probability of; left out: 0.1,0.5,1")
        ->type_name("M,M");
    command.add_option("--speed-mps", speeds, "likewise peak speeds; left out: 5,10")->type_name("MPS,MPS");
    command.add_option("--pressure-kPa", pressures, "likewise pressures, on buildings too; left out: 15,30")
        ->type_name("KPA,KPA");
}

/// Declares the options of both commands; returns that of `talus ensemble merge`.
CLI::App* add_ensemble(CLI::App& command, EnsembleArguments& ensemble, MergeArguments& merge) {
    command.require_subcommand(0, 1);
    command.add_option("scene", ensemble.scene, "scene file; left out: the built-in scene")->type_name("SCENE");
    command.add_option("-o,--output", ensemble.output, "folder; left out: talus_out/<scene name>_ensemble")
        ->type_name("DIR");
    command.add_option("--plan", ensemble.plan, "plan file with factors, design and thresholds; options go before it")
        ->type_name("FILE");
    command.add_option("--vary", ensemble.factors, "a factor; may be given many times")
        ->type_name("SECTION.KEY=DISTRIBUTION")
        ->allow_extra_args(false);
    command.add_option("--design", ensemble.design, "left out: latin_hypercube")->type_name("NAME");
    command.add_option("--runs", ensemble.runs, "at most so many; left out: 64")->type_name("N");
    command.add_option("--levels", ensemble.levels, "values per factor of a grid; left out: 5")->type_name("N");
    command.add_option("--seed", ensemble.seed, "of the design; left out: 1")->type_name("N");
    add_thresholds(command, ensemble.depths, ensemble.speeds, ensemble.pressures);
    add_overrides(command, ensemble.overrides);
    add_scene_inputs(command, ensemble.data);
    command
        .add_option("--threads", ensemble.threads, "runs side by side, a thread each; left out: all cores, 1 per rank")
        ->type_name("N")
        ->check(CLI::Range(1, 4096));
    command.add_option("--shard", ensemble.shard, "only every n-th run, from the i-th; each shard in its own folder")
        ->type_name("I/N");
    command.add_flag("--retry-failed", ensemble.retry_failed, "run again what failed in an earlier call");
    CLI::Option* quiet = command.add_flag("--quiet", ensemble.quiet, "print nothing but errors");
    command.add_flag("--json", ensemble.json, "progress and result as one JSON object per line on stdout")
        ->excludes(quiet);
    command.footer(ensemble_help);

    CLI::App* merge_app = command.add_subcommand("merge", "put shards together, or count again with other thresholds");
    merge_app->add_option("folders", merge.folders, "folders of an ensemble or its shards")
        ->required()
        ->type_name("DIR");
    merge_app->add_option("-o,--output", merge.output, "folder for all; left out: the only folder given")
        ->type_name("DIR");
    merge_app->add_option("--scene", merge.scene, "where the scene lies now; left out: where it lay")
        ->type_name("SCENE");
    add_thresholds(*merge_app, merge.depths, merge.speeds, merge.pressures);
    add_scene_inputs(*merge_app, merge.data);
    CLI::Option* merge_quiet = merge_app->add_flag("--quiet", merge.quiet, "print nothing but errors");
    merge_app->add_flag("--json", merge.json, "the result as one JSON object on stdout")->excludes(merge_quiet);
    merge_app->footer("");
    return merge_app;
}

/// The command that the user got to before the error: the one whose --help is of use.
std::string deepest_command(const CLI::App& app) {
    std::string name = app.get_name();
    const CLI::App* command = &app;
    while (!command->get_subcommands().empty()) {
        command = command->get_subcommands().front();
        name += " " + command->get_name();
    }
    return name;
}

CLI::App* add_serve(CLI::App& app, ServeArguments& serve) {
    CLI::App* command = app.add_subcommand("serve", "open a scene live in the browser: watch, steer and share it");
    command->add_option("scene", serve.scene, "scene file; left out: the built-in scene")->type_name("SCENE");
    command->add_option("--port", serve.port, "port to listen on; left out: 8123; 0: any that is free")
        ->type_name("N")
        ->check(CLI::Range(0, 65535));
    command
        ->add_option("--host", serve.host,
                     "address to listen on; left out: 127.0.0.1, this computer alone; 0.0.0.0: all")
        ->type_name("ADDRESS");
    command
        ->add_option("--allow-host", serve.allowed_hosts,
                     "a name that browsers know this server by; may be given many times")
        ->type_name("NAME")
        ->allow_extra_args(false);
    command
        ->add_option("--token", serve.tokens,
                     "secret of the links, once for controllers, again for viewers; left out: new ones each time")
        ->type_name("TOKEN")
        ->allow_extra_args(false);
    command->add_flag("--run", serve.run, "begin at once instead of paused at time 0");
    command->add_option("--threads", serve.threads, "number of threads; left out: all cores; the result is the same")
        ->type_name("N");
    add_overrides(*command, serve.overrides);
    add_scene_inputs(*command, serve.data);
    CLI::Option* quiet = command->add_flag("--quiet", serve.quiet, "print nothing but errors");
    command->add_flag("--json", serve.json, "print the links as one JSON object on stdout")->excludes(quiet);
    command->footer(serve_help);
    return command;
}

int talus_main(int argc, char** argv) {
    CLI::App app("talus simulates landslides and debris flows on a terrain model, and writes hazard maps and a report.",
                 "talus");
    app.set_version_flag("--version", "talus " TALUS_VERSION);
    app.require_subcommand(0, 1);

    RunArguments run;
    CLI::App* run_app = app.add_subcommand("run", "run a scene and write maps, tables and a report");
    run_app->add_option("scene", run.scene, "scene file; left out: the built-in scene")->type_name("SCENE");
    run_app->add_option("-o,--output", run.output, "result folder; left out: talus_out/<scene name>")->type_name("DIR");
    run_app->add_flag("--force", run.force, "replace the result folder if it is already there");
    run_app->add_option("--threads", run.threads, "number of threads; left out: all cores; the result is the same")
        ->type_name("N");
    add_overrides(*run_app, run.overrides);
    run_app->add_flag("--convergence", run.convergence,
                      "run again with half the time step, double the iterations, three times the particles; compare");
    run_app->add_option("--vary", run.variations, "run again with each of the values; compare; may be given many times")
        ->type_name("SECTION.KEY=VALUE,VALUE")
        ->allow_extra_args(false);
    add_scene_inputs(*run_app, run.data);
    CLI::Option* quiet = run_app->add_flag("--quiet", run.quiet, "print nothing but errors");
    run_app->add_flag("--json", run.json, "progress and result as one JSON object per line on stdout")->excludes(quiet);
    ServeArguments serve;
    CLI::App* serve_app = add_serve(app, serve);

    run_app->footer([] { return run_help + scene_reference_text(); });

    ReplayArguments replay;
    CLI::App* replay_app =
        app.add_subcommand("replay", "run the journal of a live session again and compare the result");
    replay_app->add_option("journal", replay.journal, "journal of a session")->required()->type_name("JOURNAL");
    replay_app->add_option("--scene", replay.scene, "scene file; left out: the one that the journal names")
        ->type_name("SCENE");
    replay_app->add_option("--threads", replay.threads, "number of threads; left out: as in the scene")
        ->type_name("N")
        ->check(CLI::Range(1, 4096));
    add_scene_inputs(*replay_app, replay.data);
    replay_app->add_flag("--quiet", replay.quiet, "print nothing but errors and what has changed");
    replay_app->footer(replay_help);

    CLI::App* scene_app = app.add_subcommand("scene", "make, check and explain scene files");
    scene_app->require_subcommand(1);

    CheckArguments check;
    CLI::App* check_app = scene_app->add_subcommand("check", "read a scene with all its inputs and say what it means");
    check_app->add_option("scene", check.scene, "scene file")->required()->type_name("SCENE");
    add_overrides(*check_app, check.overrides);
    add_scene_inputs(*check_app, check.data);

    NewSceneOptions create;
    CLI::App* new_app = scene_app->add_subcommand("new", "write a commented scene for your own terrain");
    new_app->add_option("--dem", create.dem, "terrain raster in a projected metric CRS")->required()->type_name("FILE");
    new_app->add_option("--release", create.release, "polygons of the failing ground")->required()->type_name("FILE");
    new_app->add_option("--buildings", create.buildings, "polygons of the buildings")->type_name("FILE");
    CLI::Option* thickness =
        new_app->add_option("--thickness-m", create.thickness, "thickness of the release normal to the slope, m")
            ->type_name("M");
    new_app->add_option("--volume-m3", create.volume, "volume of the release instead, m3")
        ->type_name("M3")
        ->excludes(thickness);
    new_app->add_option("-o,--output", create.folder, "folder to make for the scene")->required()->type_name("DIR");
    new_app->add_option("--particles", create.target_particle_count, "particles to aim for; more are finer and slower")
        ->type_name("N");

    std::string builtin_folder;
    bool builtin_force = false;
    CLI::App* export_app = scene_app->add_subcommand("export-builtin", "write the built-in scene with its data");
    export_app->add_option("-o,--output", builtin_folder, "folder to write it to")->required()->type_name("DIR");
    export_app->add_flag("--force", builtin_force, "write into a folder that is already there");

    CLI::App* reference_app =
        scene_app->add_subcommand("reference", "every key of a scene file with unit, default and range");
    bool markdown = false;
    reference_app->add_flag("--markdown", markdown, "as a Markdown document");

    ValidateArguments validate;
    CLI::App* validate_app = app.add_subcommand("validate", "compute cases whose results are known, print one table");
    validate_app->add_option("cases", validate.cases, "names or folders of cases; left out: all of the program's")
        ->type_name("CASE");
    validate_app->add_flag("--quick", validate.quick, "only the quick cases: under two minutes on two cores");
    validate_app->add_flag("--list", validate.list, "list the cases instead of computing them");
    validate_app->add_flag("--known", validate.known, "announced failures are no reason for exit code 4");
    validate_app->add_option("--json", validate.json, "write the table as a list of objects")->type_name("FILE");
    validate_app->add_option("--html", validate.html, "write a page with the table and a plot for each case")
        ->type_name("FILE");
    validate_app
        ->add_option("--markdown", validate.markdown, "write the same as Markdown, its plots into a folder beside it")
        ->type_name("FILE");
    validate_app->add_option("--threads", validate.threads, "number of threads; left out: all cores")
        ->type_name("N")
        ->check(CLI::Range(1, 4096));
    validate_app->add_option("--data", validate.data, "folder that TALUS_DATA names, for cases on real terrain")
        ->type_name("DIR");
    validate_app->footer(validate_help);

    EnsembleArguments ensemble;
    CLI::App* ensemble_app =
        app.add_subcommand("ensemble", "run a scene many times with varied values: probability maps, sensitivity");
    MergeArguments merge;
    CLI::App* merge_app = add_ensemble(*ensemble_app, ensemble, merge);
    CalibrateArguments calibrate;
    CLI::App* calibrate_app = add_calibrate(app, calibrate);

    BenchArguments bench;
    std::string backend = "cpu";
    CLI::App* bench_app = app.add_subcommand("bench", "measure how fast talus steps standard scenes here");
    const auto add_list = [bench_app](const std::string& name, auto& values, const std::string& help) {
        return bench_app->add_option(name, values, help)->delimiter(',')->allow_extra_args(false);
    };
    add_list("--scene", bench.scenes, "scenes to step; left out: all")
        ->type_name("NAME,NAME")
        ->check(CLI::IsMember(bench::scene_names()));
    CLI::Option* particles = add_list("--particles", bench.particles, "particles; left out: 5000,20000,75000")
                                 ->type_name("N,N")
                                 ->check(CLI::Range(bench::fewest_particles, bench::most_particles));
    bench_app->add_flag("--full", bench.full, "300000 and 1000000 particles too")->excludes(particles);
    add_list("--method", bench.methods, "how internal friction is solved; left out: both")
        ->type_name("NAME,NAME")
        ->check(CLI::IsMember(bench::method_names()));
    bench_app->add_option("--iterations", bench.iterations, "solver iterations of a step; left out: 4")
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    add_list("--threads", bench.threads, "numbers of threads; left out: all cores")
        ->type_name("N,N")
        ->check(CLI::Range(1, 4096));
    bench_app->add_option("--backend", backend, "what computes the steps; left out: cpu")
        ->type_name("NAME")
        ->check(CLI::IsMember(std::vector<std::string>{"cpu"}));
    bench_app->add_option("--repeats", bench.repeats, "repeats to take the median of; left out: 7")
        ->type_name("N")
        ->check(CLI::Range(1, 1000));
    bench_app->add_option("--steps", bench.steps, "steps per repeat; left out: 10 to 2, by the number of particles")
        ->type_name("N")
        ->check(CLI::Range(1, 100000));
    bench_app->add_option("--warm-up", bench.warm_up, "steps before the first repeat; left out: 10 to 3, likewise")
        ->type_name("N")
        ->check(CLI::Range(0, 100000));
    bench_app->add_option("--json", bench.json, "write the rows as a list of objects")->type_name("FILE");
    bench_app->add_option("--svg", bench.svg, "draw particle-iterations per second against particles")
        ->type_name("FILE");
    bench_app->footer(bench_help);

    app.footer(program_help);  // last: commands made after it would inherit it

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help_or_version) {
        return app.exit(help_or_version);
    } catch (const CLI::ParseError& error) {
        return fail(exit_code::bad_input, fmt::format("{}; see {} --help", error.what(), deepest_command(app)));
    }

    if (*run_app) return run_command(run);
    if (*replay_app) return replay_command(replay);
    if (*serve_app) return serve_command(serve);
    if (*check_app) return check_command(check);
    if (*new_app) return new_command(create);
    if (*export_app) return export_builtin_command(builtin_folder, builtin_force);
    if (*validate_app) return validate_command(validate);
    if (*merge_app) return merge_command(merge);
    if (*ensemble_app) return ensemble_command(ensemble);
    if (*calibrate_app) return calibrate_command(calibrate);
    if (*bench_app) return bench_command(bench);
    if (*reference_app) return reference_command(markdown);
    std::fputs(app.help().c_str(), stdout);
    return exit_code::success;
}

}  // namespace
}  // namespace talus

int main(int argc, char** argv) {
    // A reader that has gone and a file that may not grow are errors to report, not reasons to die.
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    try {
        return talus::talus_main(argc, argv);
    } catch (const std::bad_alloc&) {
        return talus::fail(talus::exit_code::failure,
                           "out of memory; set a larger solver.particle_spacing_m or a smaller terrain.extent");
    } catch (const std::exception& error) {
        return talus::fail(talus::exit_code::failure, error.what());
    }
}
