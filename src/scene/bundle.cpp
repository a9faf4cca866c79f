#include "scene/bundle.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/load.hpp"
#include "scene/parse.hpp"
#include "scene/toml_file.hpp"

namespace talus::scene {
namespace {

namespace fs = std::filesystem;

/// Where each value of a file stands in the text.
std::map<std::string, toml::source_position> places_of(const toml::table& root) {
    std::map<std::string, toml::source_position> places;
    const auto add = [&](const std::string& section, const toml::table& table) {
        for (const auto& [key, node] : table) {
            places[fmt::format("{}.{}", section, std::string_view(key.str()))] = node.source().begin;
        }
    };
    for (const auto& [name, node] : root) {
        const std::string section(name.str());
        if (const toml::table* table = node.as_table()) add(section, *table);
        const toml::array* entries = node.as_array();
        for (std::size_t k = 0; entries && k < entries->size(); ++k) {
            if (const toml::table* table = entries->get(k)->as_table()) add(fmt::format("{}[{}]", section, k), *table);
        }
    }
    return places;
}

/// Calls f(key path, value) for every path that is given.
template <class F>
void for_each_path(const params::SceneSpec& spec, const F& f) {
    for (const params::Section& section : params::scene_sections()) {
        for (std::size_t index = 0; index < section.count(spec); ++index) {
            for (const params::Parameter& parameter : section.parameters) {
                if (parameter.kind != params::ParameterKind::path) continue;
                const params::ParameterValue value = parameter.get(spec, index);
                const auto* text = std::get_if<std::string>(&value);
                if (text && !text->empty()) f(key_path(section, index, parameter), *text);
            }
        }
    }
}

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

/// The text with another string in place of the one that begins there.
Status replace_string(std::string& text, const toml::source_position& place, const std::string& by) {
    std::size_t at = 0;
    for (std::size_t line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
    for (std::size_t column = 1; column < place.column; ++at) {  // columns are characters, not bytes
        if ((static_cast<unsigned char>(text[at + 1]) & 0xC0) != 0x80) ++column;
    }
    const char quote = text[at];
    std::size_t end = at + 1;
    while (end < text.size() && text[end] != quote && text[end] != '\n')
        end += quote == '"' && text[end] == '\\' ? 2 : 1;
    if ((quote != '"' && quote != '\'') || end >= text.size() || text[end] != quote ||
        text.compare(at, 3, "\"\"\"") == 0) {
        return Error{"write the path as one string in quotes"};
    }
    text.replace(at, end + 1 - at, params::toml_text(by));
    return {};
}

Result<std::string> text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) return Error{file.string() + ": cannot be read"};
    std::string all = text.str();
    if (all.starts_with("\xEF\xBB\xBF")) all.erase(0, 3);  // columns are counted without the mark
    return all;
}

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

bool lies_in(const fs::path& file, const fs::path& folder) {
    std::error_code failed;
    const fs::path relative =
        fs::weakly_canonical(file, failed).lexically_relative(fs::weakly_canonical(folder, failed));
    return !failed && !relative.empty() && *relative.begin() != "..";
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
    for_each_path(parsed.spec, [&](const std::string& key, const std::string& path) {
        if (!failed) return;
        if (const auto known = packed.find(path); known != packed.end()) {
            edits.emplace_back(places.at(key), known->second);
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
        edits.emplace_back(places.at(key), packed[path]);
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

Result<fs::path> unpack_bundle(const fs::path& archive, const fs::path& folder, const geo::ZipLimits& limits) {
    TALUS_TRY(geo::unpack_zip(archive, folder, limits));
    std::error_code failed;
    const auto scenes_in = [&](const fs::path& place) {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(place, failed)) {
            if (entry.path().extension() == ".toml") found.push_back(entry.path());
        }
        std::sort(found.begin(), found.end());
        return found;
    };
    std::vector<fs::path> scenes = scenes_in(folder);
    if (scenes.empty()) {
        const std::vector<fs::path> inner(fs::directory_iterator(folder, failed), fs::directory_iterator());
        if (inner.size() == 1 && fs::is_directory(inner.front(), failed)) scenes = scenes_in(inner.front());
    }
    if (scenes.empty()) return Error{archive.string() + ": there is no scene in it: no .toml file at its top"};
    if (scenes.size() > 1) {
        return Error{fmt::format("{}: there are {} scenes in it, {} and {}; unpack it and name one", archive.string(),
                                 scenes.size(), scenes[0].filename().string(), scenes[1].filename().string())};
    }
    TALUS_ASSIGN(const ParsedScene parsed, parse_scene_with_places(scenes.front(), {}));
    Status outside;
    for_each_path(parsed.spec, [&](const std::string& key, const std::string& path) {
        if (!outside) return;
        if (!lies_in(path, scenes.front().parent_path())) {
            outside = Error{fmt::format("{}: {} in its scene names a file outside the archive", archive.string(), key)};
        } else if (fs::exists(path, failed)) {
            if (const auto files = geo::files_of(path); !files) outside = files.error();
        }
    });
    TALUS_TRY(std::move(outside));
    return scenes.front();
}

}  // namespace talus::scene
