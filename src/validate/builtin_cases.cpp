#include <algorithm>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "builtin_case_files.hpp"
#include "core/try.hpp"
#include "scene/builtin.hpp"
#include "validate/suite.hpp"

namespace talus::validate {

std::vector<std::string> builtin_case_names() {
    std::vector<std::string> names;
    for (const auto& file : builtin_case_files::files) {
        const std::filesystem::path path(file.name);
        if (path.filename() == "case.toml") names.push_back(path.parent_path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

Result<std::filesystem::path> unpack_builtin_cases(const std::filesystem::path& folder) {
    for (const auto& file : builtin_case_files::files) {
        const std::filesystem::path path = folder / file.name;
        std::error_code error;
        std::filesystem::create_directories(path.parent_path(), error);
        if (error)
            return Error{fmt::format("{}: cannot make this folder: {}", path.parent_path().string(), error.message())};
        std::ofstream stream(path, std::ios::binary);
        stream.write(file.content.data(), static_cast<std::streamsize>(file.content.size()));
        stream.close();
        if (!stream) return Error{fmt::format("{}: cannot write this file; is the disk full?", path.string())};
    }
    TALUS_TRY(scene::unpack_builtin_scene(folder / "scenes" / scene::builtin_scene_name));
    return folder / "validation";
}

}  // namespace talus::validate
