#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "serve/session.hpp"

namespace talus::serve {

/// The result files of the runs so far, written when somebody asks for one and kept until the run has gone on.
class Exports {
  public:
    /// `folder`: an existing one to write into; it is not removed.
    Exports(Session& session, std::filesystem::path folder) : session_(session), folder_(std::move(folder)) {}

    /// Answers `{"files": [...]}` for a scenario.
    void list(const std::string& scenario, const Respond& respond);
    /// Answers with a file. Errors: none of that name, disk full.
    void file(const std::string& scenario, const std::string& name, const Respond& respond);

  private:
    /// What is written of a scenario: the state that it is of, and where. Only the loop's thread touches it.
    struct Written {
        bool valid = false;
        std::uint64_t step = 0, hash = 0;
        std::filesystem::path folder;
    };
    [[nodiscard]] bool is_current(int index, const twin::Scenario& scenario) const;
    [[nodiscard]] Status write(int index, const twin::Scenario& scenario);

    Session& session_;
    std::filesystem::path folder_;
    std::array<Written, Scenarios::most> written_;
    std::uint64_t count_ = 0;  // of folders, for their names
};

}  // namespace talus::serve
