#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "core/hash.hpp"
#include "products/writers.hpp"

/// What a file says of the run that it is of.
namespace talus::products {

const char* status_text(run::RunStatus status) {
    switch (status) {
        case run::RunStatus::complete:
            return "complete";
        case run::RunStatus::interrupted:
            return "interrupted";
        case run::RunStatus::fault:
            return "fault";
    }
    return "";
}

namespace {

std::string caveat_of(bool reconstruction, const run::RunResult& result) {
    std::string text = reconstruction ? "reconstruction" : "";
    if (result.status != run::RunStatus::complete) {
        text += (text.empty() ? "" : ", ") + std::string("partial result: ") + status_text(result.status);
    }
    return text.empty() ? "" : " (" + text + ")";
}

}  // namespace

std::string scene_hash(const scene::Scene& scene) {
    for (const scene::InputFile& input : scene.inputs) {
        if (input.role == "scene") return input.hash;
    }
    return "";
}

std::string caveat(const scene::Scene& scene, const run::RunResult& result) {
    return caveat_of(scene.spec.scene.reconstruction, result);
}

std::string title_of(const scene::Scene& scene, const run::RunResult& result) {
    const params::SceneInfo& info = scene.spec.scene;
    const bool said = info.title.find("econstruction") != std::string::npos;
    return info.title + caveat_of(info.reconstruction && !said, result);
}

std::vector<std::pair<std::string, std::string>> origin_of(const scene::Scene& scene, const run::RunResult& result) {
    return {{"TIFFTAG_SOFTWARE", std::string("talus ") + TALUS_VERSION},
            {"TITLE", scene.spec.scene.title},
            {"SCENE_HASH", scene_hash(scene)},
            {"RESULT_HASH", to_hex(result.hash)},
            {"SIMULATED_TIME_S", fmt::format("{}", result.simulated_time)},
            {"STATUS", status_text(result.status)}};
}

std::vector<std::pair<std::string, std::string>> plain_origin_of(const scene::Scene& scene,
                                                                 const run::RunResult& result) {
    auto all = origin_of(scene, result);
    for (auto& [key, value] : all) {
        if (key == "TIFFTAG_SOFTWARE") key = "source";
        std::transform(key.begin(), key.end(), key.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    }
    return all;
}

}  // namespace talus::products
