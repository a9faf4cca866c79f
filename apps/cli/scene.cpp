#include "scene/scene.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "command.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "layers.hpp"
#include "params/scene_text.hpp"
#include "scene/builtin.hpp"
#include "scene/check.hpp"
#include "scene/new_scene.hpp"
#include "scene_input.hpp"
#include "zoom_text.hpp"

namespace talus::cli {
namespace {

struct CheckArguments {
    std::string scene;
    std::vector<std::string> overrides;
    std::string layers;  ///< of --layers; empty: not given
    std::string data;
};

struct ExportArguments {
    std::string folder;
    bool force = false;
};

int check_command(const CheckArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    auto overrides = with_layers(arguments.overrides, arguments.layers);
    if (!overrides) return fail(exit_code::bad_input, overrides.error().message);
    const auto found = find_scene(arguments.scene, watch);
    if (!found) return fail(exit_code::bad_input, found.error().message);
    auto scene = load_layered(found->file, *overrides, arguments.layers);
    if (!scene) return fail(exit_code::bad_input, scene.error().message);
    const auto say = [](const std::string& what) { (void)std::fputs((what + "\n").c_str(), stderr); };
    const auto settled = settle_layers(found->file, *overrides, arguments.layers, *scene, say, watch.stop_requested());
    if (!settled) return fail(exit_code::bad_input, settled.error().message);
    name_originals(*scene, found->originals);
    std::string text = describe_scene(*scene) + (*settled ? "cost        " + cost_text(**settled) + "\n" : "");
    if (scene->zoom) {
        say("running the event with the depth-averaged model, up to the zoom");
        const auto zoom = zoom_cost_text(*scene, watch.stop_requested());
        if (watch.stop_requested()) return fail(exit_code::interrupted, "interrupted");
        if (!zoom) return fail(exit_code::bad_input, zoom.error().message);
        text += *zoom;
    }
    return print_result(text);
}

int new_command(const scene::NewSceneOptions& options) {
    const auto created = write_new_scene(options);
    if (!created) return fail(exit_code::bad_input, created.error().message);
    const bool told = print(fmt::format("wrote {}\n", created->file.string())) && print_notes(created->notes);
    const int code = print_result(fmt::format("run it: talus run {}\n", created->file.string()));
    return told ? code : exit_code::failure;
}

int export_builtin_command(const ExportArguments& arguments) {
    std::error_code error;
    if (!arguments.force && std::filesystem::exists(arguments.folder, error)) {
        return fail(exit_code::bad_input, fmt::format("{}: already exists; name another folder, or write into it "
                                                      "with --force",
                                                      arguments.folder));
    }
    const auto file = scene::unpack_builtin_scene(arguments.folder);
    if (!file) return fail(exit_code::bad_input, file.error().message);
    return print_result(fmt::format("wrote {}\nrun it: talus run {}\n", file->string(), file->string()));
}

}  // namespace

void add_scene(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("scene", "make, check and explain scene files");
    app->require_subcommand(1);

    CLI::App* check_app = app->add_subcommand("check", "read a scene with all its inputs and summarise it");
    const auto check = std::make_shared<CheckArguments>();
    check_app->add_option("scene", check->scene, "scene file")->required()->type_name("SCENE");
    add_overrides(*check_app, check->overrides);
    add_layers(*check_app, check->layers, true);
    add_data_folder(*check_app, check->data);
    commands.push_back({check_app, [check] { return check_command(*check); }});

    CLI::App* new_app =
        app->add_subcommand("new", "write a commented scene for your own terrain; files may be in a .zip or .gz");
    const auto create = std::make_shared<scene::NewSceneOptions>();
    new_app->add_option("--dem", create->dem, "terrain raster in a projected metric CRS, or in local metres")
        ->required()
        ->type_name("FILE");
    new_app
        ->add_option_function<std::string>(
            "--crs", [create](const std::string&) { create->local = true; },
            "local: the terrain states no reference system and has metres of its own, as a flume")
        ->check(CLI::IsMember({"local"}))
        ->type_name("local");
    new_app->add_option("--dem-layer", create->dem_layer, "which raster of a file with several")->type_name("NAME");
    new_app
        ->add_option("--release", create->release,
                     "polygons of the release area, or closed lines; FILE|layername=NAME names a layer")
        ->required()
        ->type_name("FILE");
    new_app->add_option("--release-layer", create->release_layer, "layer of the release's file")->type_name("NAME");
    new_app
        ->add_option("--release-feature", create->release_feature,
                     "only the feature with this number (fid), or those with this value of an attribute")
        ->type_name("N|ATTRIBUTE=VALUE");
    new_app->add_option("--buildings", create->buildings, "polygons of the buildings; FILE|layername=NAME too")
        ->type_name("FILE");
    CLI::Option* thickness =
        new_app
            ->add_option(
                "--thickness-m", create->thickness,
                "thickness of the release normal to the slope, m; not needed if its polygons have an attribute "
                "thickness_m or thickness")
            ->type_name("M");
    new_app->add_option("--volume-m3", create->volume, "volume of the release instead, m3")
        ->type_name("M3")
        ->excludes(thickness);
    new_app
        ->add_option_function<std::vector<double>>(
            "--extent",
            [create](const std::vector<double>& e) {
                create->extent = Extent{e[0], e[1], e[2], e[3]};
            },
            "part of the terrain to use, in its coordinates; otherwise all that debris could reach")
        ->expected(4)
        ->type_name("XMIN YMIN XMAX YMAX");
    new_app
        ->add_option("--cell", create->cell,
                     "size of the terrain's cells, m: a whole multiple of the raster's, whose means are written to the "
                     "folder")
        ->type_name("M");
    new_app->add_option("-o,--output", create->folder, "folder to make for the scene")->required()->type_name("DIR");
    new_app
        ->add_option("--particles", create->target_particle_count,
                     "target number of particles; more are finer and slower")
        ->type_name("N");
    commands.push_back({new_app, [create] { return new_command(*create); }});

    CLI::App* export_app = app->add_subcommand("export-builtin", "write the built-in scene with its data");
    const auto exported = std::make_shared<ExportArguments>();
    export_app->add_option("-o,--output", exported->folder, "folder to write it to")->required()->type_name("DIR");
    export_app->add_flag("--force", exported->force, "write into an existing folder");
    commands.push_back({export_app, [exported] { return export_builtin_command(*exported); }});

    CLI::App* reference_app =
        app->add_subcommand("reference", "every key of a scene file with unit, default and range");
    const auto markdown = std::make_shared<bool>(false), typescript = std::make_shared<bool>(false);
    reference_app->add_flag("--markdown", *markdown, "as a Markdown document");
    reference_app->add_flag("--typescript", *typescript, "the live keys as types and form fields of the page");
    commands.push_back({reference_app, [markdown, typescript] {
                            if (*typescript) return print_result(params::scene_typescript());
                            return print_result(*markdown ? params::scene_reference_markdown()
                                                          : params::scene_reference_text());
                        }});
}

}  // namespace talus::cli
