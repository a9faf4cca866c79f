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
#include "help.hpp"
#include "params/scene_text.hpp"
#include "scene/new_scene.hpp"

namespace talus {
namespace {

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
    command
        ->add_option("--calibrations", serve.calibrations,
                     "folder that keeps the runs and the report of calibrations started in the page; left out: gone "
                     "with the program")
        ->type_name("DIR");
    command
        ->add_option("--ensemble", serve.ensembles,
                     "folder of a finished talus ensemble of this scene, whose maps the page shows; may be given many "
                     "times")
        ->type_name("DIR")
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
    const auto add_list = [bench_app](const std::string& name, auto& values, const std::string& text) {
        return bench_app->add_option(name, values, text)->delimiter(',')->allow_extra_args(false);
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
