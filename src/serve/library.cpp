#include "serve/library.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/hash.hpp"
#include "core/try.hpp"
#include "geo/json_text.hpp"
#include "scene/builtin.hpp"
#include "scene/scene.hpp"
#include "session/json_text.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t recent_count = 12, longest_file_name = 60;
constexpr std::uintmax_t longest_list = 1'000'000;

json read_json(const fs::path& file, std::uintmax_t longest) {
    const auto text = read_whole(file, longest);
    if (!text) return {};
    auto parsed = session::parse_json(*text, Library::most_session_values);
    return parsed ? std::move(*parsed) : json();
}

std::string title_of(const fs::path& scene) {
    const auto spec = scene::parse_scene(scene);
    if (spec && !spec->scene.title.empty()) return spec->scene.title;
    return scene.parent_path().filename().string();
}

/// Files of a folder in the order of their names.
std::vector<fs::path> sorted_entries(const fs::path& folder) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        entries.push_back(it->path());
    }
    std::sort(entries.begin(), entries.end());
    return entries;
}

}  // namespace

std::string utc_now() {
    const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

std::string file_name_of(const std::string& name) {
    std::string made;
    for (const unsigned char c : name) {
        if (std::isalnum(c) != 0 && c < 128) {
            made += static_cast<char>(std::tolower(c));
        } else if (!made.empty() && made.back() != '-') {
            made += '-';
        }
    }
    if (made.size() > longest_file_name) made.resize(longest_file_name);
    while (!made.empty() && made.back() == '-') made.pop_back();
    return made;
}

std::string with_name(std::string sentence, const fs::path& path, const std::string& name) {
    const std::string wanted = path.string();
    for (std::size_t at = 0; (at = sentence.find(wanted, at)) != std::string::npos; at += name.size()) {
        sentence.replace(at, wanted.size(), name);
    }
    return sentence;
}

std::string without_folder(const std::string& sentence, const fs::path& folder) {
    return with_name(with_name(sentence, folder / "", ""), folder, "its folder");
}

Status write_whole(const fs::path& file, const std::string& text) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) return Error{fmt::format("{}: cannot be made: {}", file.parent_path().string(), error.message())};
    const fs::path part = file.string() + ".part";
    std::ofstream out(part, std::ios::binary);
    out << text;
    out.close();
    if (out) fs::rename(part, file, error);
    if (out && !error) return {};
    fs::remove(part, error);
    return Error{fmt::format("{}: cannot be written; is the disk full?", file.string())};
}

Result<std::string> read_whole(const fs::path& file, std::uintmax_t longest) {
    std::error_code error;
    const auto size = fs::is_regular_file(file, error) ? fs::file_size(file, error) : 0;
    if (error || size == 0) return Error{fmt::format("{}: cannot be read", file.string())};
    if (size > longest) return Error{fmt::format("{}: is longer than {} bytes", file.string(), longest)};
    std::ifstream in(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!in) return Error{fmt::format("{}: cannot be read", file.string())};
    return text;
}

std::string Library::id_of(const fs::path& file) {
    StateHash hash;
    const std::string text = file.string();
    hash.add(text.data(), text.size());
    return to_hex(hash.value());
}

std::vector<KnownScene> Library::scenes() const {
    std::vector<KnownScene> known;
    std::set<std::string> seen;
    std::error_code error;
    const json recent = read_json(folder_ / "recent.json", longest_list);
    const std::string own = (scenes_folder() / "").string();
    for (const json& entry : recent.is_array() ? recent : json::array()) {
        KnownScene scene;
        scene.file = session::text_at(entry, "file");
        scene.title = session::text_at(entry, "title");
        scene.opened_at = session::text_at(entry, "opened_at");
        if (scene.file.empty()) continue;
        scene.id = id_of(scene.file);
        scene.missing = !fs::is_regular_file(scene.file, error);
        if (scene.file.string().starts_with(own)) {
            if (scene.missing) continue;
            scene.kind = KnownScene::Kind::own;
        }
        if (seen.insert(scene.id).second) known.push_back(std::move(scene));
    }
    for (const fs::path& folder : sorted_entries(scenes_folder())) {
        KnownScene scene;
        scene.kind = KnownScene::Kind::own;
        scene.file = folder / "scene.toml";
        scene.id = id_of(scene.file);
        if (!fs::is_regular_file(scene.file, error) || !seen.insert(scene.id).second) continue;
        scene.title = title_of(scene.file);
        known.push_back(std::move(scene));
    }
    known.push_back({std::string(scene::builtin_scene_name),
                     "Sham Tseng San Tsuen 1999 (reconstruction)",
                     KnownScene::Kind::builtin,
                     {},
                     {},
                     false});
    return known;
}

std::vector<SavedSession> Library::sessions() const {
    std::vector<SavedSession> saved;
    for (const fs::path& file : sorted_entries(folder_ / "sessions")) {
        if (file.extension() != ".json") continue;
        const json content = read_json(file, longest_session);
        if (!content.is_object() || !content.contains("talus_session")) continue;
        SavedSession one;
        one.id = file.stem().string();
        one.file = file;
        one.name = session::text_at(content, "name");
        one.title = session::text_at(content, "title");
        one.saved_at = session::text_at(content, "saved_at");
        const auto list = content.find("scenarios");
        one.scenarios = list != content.end() && list->is_array() ? static_cast<int>(list->size()) : 0;
        saved.push_back(std::move(one));
    }
    std::stable_sort(saved.begin(), saved.end(),
                     [](const SavedSession& a, const SavedSession& b) { return a.saved_at > b.saved_at; });
    return saved;
}

Status Library::remember(const fs::path& file, const std::string& title) const {
    const fs::path whole = fs::absolute(file).lexically_normal();
    json list = json::array({{{"file", whole.string()}, {"title", title}, {"opened_at", utc_now()}}});
    const json before = read_json(folder_ / "recent.json", longest_list);
    for (const json& entry : before.is_array() ? before : json::array()) {
        if (list.size() < recent_count && session::text_at(entry, "file") != whole.string()) list.push_back(entry);
    }
    return write_whole(folder_ / "recent.json", session::to_text(list) + "\n");
}

Status Library::forget(const std::string& id) const {
    json list = json::array();
    const json before = read_json(folder_ / "recent.json", longest_list);
    for (const json& entry : before.is_array() ? before : json::array()) {
        if (id_of(session::text_at(entry, "file")) != id) list.push_back(entry);
    }
    if (!before.is_array() || list.size() == before.size()) return Error{"this scene is not among the recent ones"};
    return write_whole(folder_ / "recent.json", session::to_text(list) + "\n");
}

Status Library::remove_scene(const std::string& id) const {
    for (const KnownScene& known : scenes()) {
        if (known.id != id || known.kind != KnownScene::Kind::own) continue;
        std::error_code error;
        fs::remove_all(known.file.parent_path(), error);
        if (error) return Error{fmt::format("{}: cannot be deleted: {}", known.file.string(), error.message())};
        (void)forget(id).ok();
        return {};
    }
    return Error{"there is no scene of this id that was made here"};
}

Result<std::string> Library::save_session(const std::string& name, const std::string& text) const {
    const std::string id = file_name_of(name);
    if (id.empty()) return Error{"a session needs a name with letters or digits"};
    if (text.size() > longest_session || geo::json_values(text) > most_session_values) {
        return Error{
            fmt::format("the session is too long to be opened again: {:.1f} MB with {} values; at most "
                        "{:.0f} MB with {} are read",
                        static_cast<double>(text.size()) / 1e6, geo::json_values(text),
                        static_cast<double>(longest_session) / 1e6, most_session_values)};
    }
    TALUS_TRY(write_whole(folder_ / "sessions" / (id + ".json"), text));
    return id;
}

Status Library::remove_session(const std::string& id) const {
    for (const SavedSession& saved : sessions()) {
        std::error_code error;
        if (saved.id == id && fs::remove(saved.file, error)) return {};
    }
    return Error{"there is no saved session of that name"};
}

}  // namespace talus::serve
