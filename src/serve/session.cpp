#include "serve/session.hpp"

#include "core/try.hpp"

namespace talus::serve {

using nlohmann::json;
using session::Kept;

Session::Session(Thread thread, Executor& executor, std::shared_ptr<const scene::Scene> scene, Tokens tokens)
    : thread_(std::move(thread)), executor_(executor), scene_(std::move(scene)), tokens_(std::move(tokens)) {}

Session::~Session() {
    close();
}

void Session::close() {
    loop_.reset();
    packer_.close();
    worker_.close();
}

Status Session::open(twin::ScenarioOptions options, std::function<void(std::string)> failed) {
    session::Room::Settings room;
    TALUS_ASSIGN(room.id, random_token());
    room.program = "talus " TALUS_VERSION;
    room.title = scene_->spec.scene.title;
    // For the page's links to share: no one receives a token with more permissions than their own.
    room.links = [this](Role role) {
        messages::Session::Links links{.viewer = tokens_.viewer};
        if (role == Role::controller) links.controller = tokens_.controller;
        return links;
    };
    room.watching = [this](std::vector<Audience> audience) {
        if (loop_) loop_->post([audience = std::move(audience)](Scenarios& all) { all.set_audience(audience); });
    };
    room_ = std::make_unique<session::Room>(std::move(room));
    TALUS_ASSIGN(loop_, Loop::start(executor_, scene_, std::move(options), *this, std::move(failed)));
    return {};
}

void Session::join(Viewer& viewer, Role role, const std::string& name, const std::string& former) {
    room_->join(viewer, role, name, former, Clock::now());
    arm_tick();
}

void Session::leave(Viewer& viewer) {
    room_->leave(viewer, Clock::now());
    arm_tick();
}

bool Session::receive(Viewer& viewer, std::string_view text) {
    const bool welcome = room_->receive(viewer, text, Clock::now());
    arm_tick();
    return welcome;
}

void Session::people_changed() {
    room_->people_changed(Clock::now());
    arm_tick();
}

void Session::tick() {
    ticking_ = false;
    room_->tick(Clock::now());
    arm_tick();
}

void Session::arm_tick() {
    if (ticking_ || !room_->waiting()) return;
    ticking_ = true;
    thread_.tick_after(session::Room::tick_time);
}

void Session::frames(FrameSet set) {
    const std::lock_guard lock(frames_mutex_);
    const auto index = static_cast<std::size_t>(set.scenario);
    arrived_[index] = std::move(set);
    if (std::exchange(packing_posted_, true)) return;
    packer_.post([this] { pack_frames(); });
}

void Session::pack_frames() {
    std::array<std::optional<FrameSet>, Scenarios::max_count> arrived;
    {
        const std::lock_guard lock(frames_mutex_);
        arrived.swap(arrived_);
        packing_posted_ = false;
    }
    std::array<std::optional<session::PackedFrames>, Scenarios::max_count> packed;
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (arrived[i]) packed[i] = session::pack(*arrived[i]);
    }
    const std::lock_guard lock(frames_mutex_);
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (packed[i]) packed_[i] = std::move(packed[i]);
    }
    if (std::exchange(delivery_posted_, true)) return;
    thread_.post([this] { deliver_frames(); });
}

void Session::deliver_frames() {
    std::array<std::optional<session::PackedFrames>, Scenarios::max_count> packed;
    {
        const std::lock_guard lock(frames_mutex_);
        packed.swap(packed_);
        delivery_posted_ = false;
    }
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (packed[i]) room_->deliver(i, std::move(*packed[i]));
    }
}

/// The text is made on the thread that calls.
void Session::keep(Kept what, int scenario, json message) {
    thread_.post([this, what, scenario, text = session::message_text(what, std::move(message))] {
        room_->keep(what, scenario, text);
    });
}

void Session::state(int scenario, json state) {
    keep(Kept::state, scenario, std::move(state));
}

void Session::setup(int scenario, json told, const twin::Setup& setup) {
    if (scenario == 0) {
        thread_.post([this, setup] {
            if (on_first_setup_) on_first_setup_(setup);
        });
    }
    keep(Kept::setup, scenario, std::move(told));
    setups_changed_();
}

void Session::calibration(json status) {
    keep(Kept::calibration, session::Room::whole_session, std::move(status));
}

void Session::overlays(json list) {
    keep(Kept::overlays, session::Room::whole_session, std::move(list));
}

void Session::alerts(json status) {
    keep(Kept::alerts, session::Room::whole_session, std::move(status));
}

void Session::depth_averaged(int scenario, json status) {
    keep(Kept::depth_averaged, scenario, std::move(status));
}

void Session::alerts(int scenario, RunAlerts alerts) {
    thread_.post([this, scenario, alerts = std::move(alerts)] {
        if (on_alerts_) on_alerts_(scenario, alerts);
    });
}

void Session::done(int scenario, const std::string& by, const std::string& sentence) {
    thread_.post([this, scenario, by, sentence] { room_->done(scenario, by, sentence); });
}

void Session::scenarios(std::vector<std::string> names) {
    thread_.post([this, names = std::move(names)] { room_->scenarios(names); });
    setups_changed_();
}

}  // namespace talus::serve
