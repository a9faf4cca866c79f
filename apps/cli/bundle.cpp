#include "scene/bundle.hpp"

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "command.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "scene_input.hpp"

namespace talus::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* bundle_help = R"(
The archive holds the scene as scene.toml, with the paths in it changed, and every file that it names below data/. run,
scene check, compare, serve, ensemble, calibrate and replay take it in place of a scene file, with the same results.)";

struct BundleArguments {
    std::string scene, archive, data;
    bool force = false;
};

int bundle_command(const BundleArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    InterruptWatch watch;
    std::error_code error;
    if (!scene::is_bundle(arguments.archive)) {
        return fail(exit_code::bad_input, fmt::format("{}: the name of a bundle ends in .zip", arguments.archive));
    }
    if (!arguments.force && fs::exists(fs::symlink_status(arguments.archive, error))) {
        return fail(
            exit_code::bad_input,
            fmt::format("{}: already exists; name another file, or replace it with --force", arguments.archive));
    }
    const auto found = find_scene(arguments.scene, watch);
    if (!found) return fail(exit_code::bad_input, found.error().message);
    const auto packed = scene::write_bundle(found->file, arguments.archive);
    if (!packed) return fail(exit_code::bad_input, packed.error().message);
    return print_result(fmt::format("wrote {}: the scene and {} files, {:.3g} MB\nrun it: talus run {}\n",
                                    arguments.archive, packed->files, static_cast<double>(packed->bytes) / 1e6,
                                    arguments.archive));
}

}  // namespace

void add_bundle(CLI::App& program, std::vector<Command>& commands) {
    CLI::App* app = program.add_subcommand("bundle", "pack a scene and all its files into one archive");
    const auto bundle = std::make_shared<BundleArguments>();
    app->add_option("scene", bundle->scene, "scene file")->required()->type_name("SCENE");
    app->add_option("-o,--output", bundle->archive, "archive to write")->required()->type_name("FILE.zip");
    app->add_flag("--force", bundle->force, "replace the archive if it exists");
    add_data_folder(*app, bundle->data);
    app->footer(bundle_help);
    commands.push_back({app, [bundle] { return bundle_command(*bundle); }});
}

}  // namespace talus::cli
