#include "scene/bundle.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "params/paths.hpp"
#include "scene/load.hpp"
#include "scene/parse.hpp"
#include "scene/scene_text_edits.hpp"
#include "scene/toml_file.hpp"

namespace talus::scene {
namespace {

namespace fs = std::filesystem;

Status check_variants(const ParsedScene& parsed) {
    for (std::size_t i = 0; i < parsed.spec.variants.size(); ++i) {
        for (const std::string& set : parsed.spec.variants[i].set) {
            const std::size_t dot = set.find('.'), equals = set.find('=');
            const params::Section* section = params::find_section(set.substr(0, std::min(dot, set.find('['))));
            const params::Parameter* parameter =
                section && equals != std::string::npos ? section->find(set.substr(dot + 1, equals - dot - 1)) : nullptr;
            if (!parameter || parameter->kind != params::ParameterKind::path) continue;
            return Error{fmt::format("{} \"{}\" names a file, which is not packed; make a scene of it",
                                     parsed.at(fmt::format("variant[{}].set", i)), parsed.spec.variants[i].name)};
        }
    }
    return {};
}

/// Names in the archive: data/NAME, or data/2/NAME where another file has the name.
class Names {
  public:
    /// The folder in the archive for a file and those that belong to it.
    std::string folder_for(const std::vector<std::string>& names) {
        for (std::size_t k = 1;; ++k) {
            std::string folder = k == 1 ? "data/" : fmt::format("data/{}/", k);
            const bool free = std::none_of(names.begin(), names.end(),
                                           [&](const std::string& name) { return taken_.contains(folder + name); });
            if (!free) continue;
            for (const std::string& name : names) taken_.insert(folder + name);
            return folder;
        }
    }

  private:
    std::set<std::string> taken_;
};

/// The file that a path of the scene names, and all that belong to it.
Result<std::vector<fs::path>> files_of(const fs::path& file, const Scene& scene) {
    std::error_code failed;
    if (!fs::is_regular_file(file, failed)) return Error{file.string() + ": is not a file that can be packed"};
    TALUS_ASSIGN(auto all, geo::files_of(file));
    if (file == scene.spec.buildings.file) {  // a mesh with its buffers
        for (const InputFile& input : scene.inputs) {
            if (input.role.starts_with("buildings") && std::find(all.begin(), all.end(), input.path) == all.end()) {
                all.emplace_back(input.path);
            }
        }
    }
    return all;
}

}  // namespace

bool is_bundle(const fs::path& scene) {
    const std::string ending = scene.extension().string();
    return ending == ".zip" || ending == ".ZIP";
}

Result<Packed> write_bundle(const fs::path& scene_file, const fs::path& archive) {
    TALUS_ASSIGN(const toml::table root, read_toml_file(scene_file, "scene"));
    TALUS_ASSIGN(const ParsedScene parsed, parse_scene_with_places(scene_file, {}));
    TALUS_TRY(check_variants(parsed));
    TALUS_ASSIGN(const Scene scene, assemble_scene(parsed));
    TALUS_ASSIGN(std::string text, text_of(scene_file));

    std::vector<std::pair<toml::source_position, std::string>> edits;
    std::vector<geo::ZipEntry> entries(1);
    std::map<fs::path, std::string> packed;  // a file that several keys name, once
    Names names;
    Packed done;
    Status failed;
    const auto places = places_of(root);
    params::for_each_path(parsed.spec, [&](const params::Section& section, std::size_t index,
                                           const params::Parameter& parameter, const std::string& path) {
        const std::string key = key_path(section, index, parameter);
        if (!failed) return;
        if (const auto known = packed.find(path); known != packed.end()) {
            edits.emplace_back(places.at(key), known->second + layer_behind(parsed, section, index, parameter));
            return;
        }
        const auto files = files_of(path, scene);
        if (!files) {
            failed = Error{parsed.at(key) + ": " + files.error().message};
            return;
        }
        std::vector<std::string> relative;
        for (const fs::path& file : *files) {
            const fs::path name = file.lexically_relative(fs::path(path).parent_path());
            if (name.empty() || *name.begin() == "..") {
                failed =
                    Error{fmt::format("{}: it needs {}, which is not in its folder", parsed.at(key), file.string())};
                return;
            }
            relative.push_back(name.generic_string());
        }
        const std::string folder = names.folder_for(relative);
        for (std::size_t k = 0; k < relative.size(); ++k) {
            std::error_code ignored;
            entries.push_back({folder + relative[k], (*files)[k]});
            done.bytes += fs::file_size((*files)[k], ignored);
        }
        packed[path] = folder + relative.front();
        edits.emplace_back(places.at(key), packed[path] + layer_behind(parsed, section, index, parameter));
    });
    TALUS_TRY(std::move(failed));
    // From the end on, so that the places before stay.
    std::sort(edits.begin(), edits.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first.line, a.first.column) > std::pair(b.first.line, b.first.column);
    });
    for (const auto& [place, path] : edits) {
        if (Status s = replace_string(text, place, path); !s) {
            return Error{fmt::format("{}:{}: {}", scene_file.string(), place.line, s.error().message)};
        }
    }
    entries[0] = {"scene.toml", {}, text};
    done.files = entries.size() - 1;
    TALUS_TRY(geo::write_zip(archive, entries));
    return done;
}

}  // namespace talus::scene
