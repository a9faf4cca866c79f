#include "extras.hpp"

#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace talus::cli {

Extras::Extras(const scene::Scene& scene, const std::optional<SavedState>& save, std::filesystem::path folder,
               const std::filesystem::path& final_folder, std::function<void(const std::string&)> say)
    : save_(save), folder_(std::move(folder)), say_(std::move(say)) {
    if (products::Series::wanted(scene)) series_.emplace(scene, folder_ / "series", final_folder / "series");
    if (products::Tracks::wanted(scene)) tracks_.emplace(scene);
}

void Extras::take_part(run::RunOptions& options) {
    if (save_) {
        options.save_time = save_->time;
        options.on_state = [this](const std::string& state, double time) { save(state, time); };
    }
    if (series_ || tracks_) options.on_frame = [this](const run::Frame& frame) { add(frame); };
}

void Extras::note(const Status& status) {
    if (!status) failures_.push_back(status.error().message);
}

void Extras::add(const run::Frame& frame) {
    if (tracks_) tracks_->add(frame);
    if (!series_) return;
    const Status added = series_->add(frame);
    if (added) return;
    note(added);
    series_.reset();  // without this frame it would be another run
    std::error_code ignored;
    std::filesystem::remove_all(folder_ / "series", ignored);
}

void Extras::save(const std::string& state, double time) {
    if (!save_) return;
    const Status written = write_state_file(save_->file, state);
    note(written);
    if (!written || !save_->time || time >= *save_->time - 1e-9) return;
    say_(fmt::format("{} has the state at {:.6g} s, when the run ended before the {:.6g} s of --save-state",
                     save_->file.string(), time, *save_->time));
}

void Extras::finish(const run::RunResult& result) {
    if (series_) {
        for (std::string& failure : series_->finish(result)) failures_.push_back(std::move(failure));
    }
    if (tracks_) note(tracks_->write(folder_));
}

}  // namespace talus::cli
