#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "commands.hpp"
#include "exit_code.hpp"
#include "params/scene_text.hpp"
#include "scene/builtin.hpp"
#include "scene/check.hpp"
#include "scene/new_scene.hpp"
#include "scene/scene.hpp"

namespace talus {
namespace {

/// On a full disk or a closed pipe the text is lost; a script must be able to tell.
int print_all(const std::string& text) {
    if (std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0) return exit_code::success;
    return fail(exit_code::failure, "cannot write to standard output");
}

}  // namespace

int check_command(const CheckArguments& arguments) {
    if (!arguments.data.empty()) set_data_folder(arguments.data);
    const auto scene = load_scene(arguments.scene, arguments.overrides);
    if (!scene) return fail(exit_code::bad_input, scene.error().message);
    return print_all(describe_scene(*scene));
}

int new_command(const NewSceneOptions& options) {
    const auto created = write_new_scene(options);
    if (!created) return fail(exit_code::bad_input, created.error().message);
    std::string text = fmt::format("wrote {}\n", created->file.string());
    for (const std::string& note : created->notes) text += fmt::format("note: {}\n", note);
    return print_all(text + fmt::format("run it: talus run {}\n", created->file.string()));
}

int export_builtin_command(const std::string& folder, bool force) {
    std::error_code error;
    if (!force && std::filesystem::exists(folder, error)) {
        return fail(exit_code::bad_input, fmt::format("{}: is already there; name another folder, or write into it "
                                                      "with --force",
                                                      folder));
    }
    const auto file = unpack_builtin_scene(folder);
    if (!file) return fail(exit_code::bad_input, file.error().message);
    return print_all(fmt::format("wrote {}\nrun it: talus run {}\n", file->string(), file->string()));
}

int reference_command(bool markdown) {
    return print_all(markdown ? scene_reference_markdown() : scene_reference_text());
}

}  // namespace talus
