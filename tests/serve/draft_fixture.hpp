#pragma once

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <cpl_vsi.h>
#include <nlohmann/json.hpp>

#include "geo/zip_archive.hpp"
#include "serve/start_fixture.hpp"

namespace talus::test {

class NewScenePage : public StartPage {
  protected:
    void SetUp() override {
        StartPage::SetUp();
        client_ = std::make_unique<HttpClient>(server_->port(), controller);
        draft_ = "/api/draft/" + begin();
    }
    std::string begin() { return client_->ask("POST", "/api/draft", "{}").json()["created"]; }
    Answer put(const std::string& role, const std::string& name, const std::string& content) {
        return client_->ask("PUT", draft_ + "/files/" + role + "?name=" + name, content);
    }
    Answer put_file(const std::string& role, const std::string& file) {
        return put(role, std::filesystem::path(file).filename().string(), read_text(file));
    }
    Answer check(nlohmann::json wanted) {
        wanted["check"] = true;
        return client_->post(draft_ + "/scene", wanted);
    }
    std::string zip(const std::vector<geo::ZipEntry>& entries) const {
        const std::string file = scene_.input("packed.zip");
        EXPECT_TRUE(geo::write_zip(file, entries));
        return read_text(file);
    }
    std::string gzip(const std::string& text) const {
        const std::string file = scene_.input("packed.gz");
        VSILFILE* const out = VSIFOpenL(("/vsigzip/" + file).c_str(), "wb");
        EXPECT_NE(out, nullptr);
        EXPECT_EQ(VSIFWriteL(text.data(), 1, text.size(), out), text.size());
        VSIFCloseL(out);
        return read_text(file);
    }
    /// Every file below the drafts and the scenes, without those of the given draft's folder name.
    [[nodiscard]] std::vector<std::string> kept() const {
        std::vector<std::string> files;
        for (const char* name : {"drafts", "scenes"}) {
            if (!std::filesystem::exists(folder() / name)) continue;
            for (const auto& entry : std::filesystem::recursive_directory_iterator(folder() / name)) {
                if (entry.is_regular_file()) files.push_back(entry.path().filename().string());
            }
        }
        std::sort(files.begin(), files.end());
        return files;
    }
    static nlohmann::json scar() { return {{824200, 825090}, {824220, 825090}, {824220, 825110}, {824200, 825110}}; }

    std::unique_ptr<HttpClient> client_;
    std::string draft_;
};

}  // namespace talus::test
