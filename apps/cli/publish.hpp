#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "interrupt.hpp"
#include "scene/scene.hpp"
#include "serve/publisher.hpp"

namespace talus::cli {

/// How a twin is published.
struct PublishOptions {
    serve::RecordOptions recording = {};
    bool without_engine = false;
    bool folder = false;  ///< a folder for a web server in place of one file
};

/// Whether a twin can be published so. Error: this program has no engine, and it is not left out.
[[nodiscard]] Status check_publish(const PublishOptions& options);

/// A published twin in memory, and what to say of it.
struct Twin {
    std::vector<publish::File> files;  ///< one without a name; or those of a folder
    std::string contents;              ///< lines for the user
    std::string hash;
    std::size_t bytes = 0;
};

/// As serve::publish. Errors: as there.
[[nodiscard]] Result<Twin> make_twin(serve::ToPublish wanted, const PublishOptions& options,
                                     const serve::SayShare& say);

}  // namespace talus::cli
