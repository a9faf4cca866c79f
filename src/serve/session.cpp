#include "serve/session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/try.hpp"
#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

constexpr int protocol_version = 1;
constexpr milliseconds tick_time{100};
constexpr std::size_t crowd = 50;  // up to this number, people get the list ten times a second; above it, less often

Bytes message_text(const char* type, json message) {
    message["type"] = type;
    return std::make_shared<const std::string>(to_text(message));
}

/// Three finite numbers; empty for null. False: neither.
bool read_mark(const json& at, std::optional<std::array<double, 3>>& mark) {
    mark.reset();
    if (at.is_null()) return true;
    if (!at.is_array() || at.size() != 3) return false;
    std::array<double, 3> position{};
    for (std::size_t i = 0; i < 3; ++i) {
        if (!at[i].is_number()) return false;
        position[i] = at[i].get<double>();
        if (!std::isfinite(position[i])) return false;
    }
    mark = position;
    return true;
}

}  // namespace

Session::Session(Thread thread, std::shared_ptr<const scene::Scene> scene, Tokens tokens)
    : thread_(std::move(thread)), scene_(std::move(scene)), tokens_(std::move(tokens)) {}

Session::~Session() {
    close();
}

void Session::close() {
    loop_.reset();
    packer_.reset();
    worker_.reset();
}

Status Session::open(twin::ScenarioOptions options, std::function<void(std::string)> failed) {
    TALUS_ASSIGN(id_, random_token());
    TALUS_ASSIGN(loop_, Loop::start(scene_, std::move(options), *this, std::move(failed)));
    return {};
}

json Session::describe(Role role) const {
    json session = people_.to_json();
    session["protocol"] = protocol_version;
    session["id"] = id_;
    session["program"] = "talus " TALUS_VERSION;
    session["title"] = scene_->spec.scene.title;
    session["you"] = {{"role", role_name(role)}};
    session["scenarios"] = names_;
    // For the page's links to share: no one receives a token with more permissions than their own.
    session["links"] = {{"viewer", tokens_.viewer}};
    if (role == Role::controller) session["links"]["controller"] = tokens_.controller;
    return session;
}

void Session::join(Viewer& viewer, Role role, const std::string& name, const std::string& former) {
    const Person& who = people_.join(role, name, former, Clock::now());
    viewers_[&viewer].person = who.id;
    json you = {
        {"id", who.id}, {"name", who.name}, {"role", role_name(role)}, {"colour", who.colour}, {"secret", who.secret}};
    viewer.send(message_text("hello", {{"protocol", protocol_version}, {"you", you}, {"session", describe(role)}}));
    for (std::size_t i = 0; i < setups_.size(); ++i) {
        if (setups_[i]) viewer.send(setups_[i]);
        if (states_[i]) viewer.send(states_[i]);
        if (depth_averaged_[i]) viewer.send(depth_averaged_[i]);
    }
    if (calibration_) viewer.send(calibration_);
    if (alerts_) viewer.send(alerts_);
    people_changed();
}

void Session::leave(Viewer& viewer) {
    const auto found = viewers_.find(&viewer);
    if (found == viewers_.end()) return;
    people_.leave(found->second.person, Clock::now());
    viewers_.erase(found);
    update_audience();
    people_changed();
}

void Session::dismiss_all() {
    const auto viewers = std::exchange(viewers_, {});
    for (const auto& [viewer, view] : viewers) viewer->dismiss(message_text("ended", json::object()));
}

bool Session::receive(Viewer& viewer, std::string_view text) {
    const auto parsed = parse_json(text);
    if (!parsed || !parsed->is_object()) return false;
    const json& message = *parsed;
    const auto type = message.find("type");
    const auto found = viewers_.find(&viewer);
    if (type == message.end() || found == viewers_.end()) return false;
    View& view = found->second;
    const auto only = [&](std::initializer_list<std::string_view> keys) {
        return twin::check_keys(message, keys).ok();
    };
    if (*type == "view") {
        if (!only({"type", "scenarios", "rate_hz", "particle_cap"})) return false;
        try {
            return set_view(viewer, view, message);
        } catch (const json::exception&) {
            return false;  // something is missing, or of another type
        }
    }
    if (*type == "mark") {
        std::optional<std::array<double, 3>> mark;
        if (!only({"type", "at"}) || !message.contains("at") || !read_mark(message["at"], mark)) return false;
        people_.set_mark(view.person, mark);
        people_changed();
        return true;
    }
    if (*type == "name") {
        if (!only({"type", "name"}) || !message.contains("name") || !message["name"].is_string()) return false;
        people_.rename(view.person, message["name"].get<std::string>());
        people_changed();
        return true;
    }
    return false;
}

bool Session::set_view(Viewer& viewer, View& view, const json& message) {
    View wanted;
    wanted.person = view.person;
    const json& scenarios = message.at("scenarios");
    if (!scenarios.is_array()) return false;
    for (const json& name : scenarios) {
        const std::string text = name.get<std::string>();
        for (int i = 0; i < Scenarios::max_count; ++i)
            wanted.looks[i] = wanted.looks[i] || text == Scenarios::name_of(i);
    }
    wanted.rate_hz = std::clamp(message.at("rate_hz").get<double>(), 0.1, Scenarios::highest_rate);
    const double cap = message.at("particle_cap").get<double>();
    wanted.cap = static_cast<unsigned>(std::clamp(cap, double{Scenarios::lowest_cap}, 1e9));
    view = wanted;
    viewer.set_rate(view.rate_hz);
    update_audience();
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (view.looks[i]) offer_newest(viewer, view, i);
    }
    return true;
}

/// If this changes which frames are needed, the loop makes one immediately.
void Session::update_audience() {
    std::vector<Audience> audience(Scenarios::max_count);
    for (const auto& [viewer, view] : viewers_) {
        for (int i = 0; i < Scenarios::max_count; ++i) {
            if (!view.looks[i]) continue;
            audience[i].rate_hz = std::max(audience[i].rate_hz, view.rate_hz);
            audience[i].caps.push_back(view.cap);
        }
    }
    for (int i = 0; i < Scenarios::max_count; ++i) {
        auto& caps = audience[i].caps;
        std::sort(caps.begin(), caps.end());
        caps.erase(std::unique(caps.begin(), caps.end()), caps.end());
        if (caps.empty()) newest_[i] = {};
    }
    if (audience == audience_) return;
    audience_ = audience;
    if (loop_) loop_->post([audience = std::move(audience)](Scenarios& all) { all.set_audience(audience); });
}

void Session::offer_newest(Viewer& viewer, const View& view, int scenario) {
    for (const auto& [cap, frame] : newest_[static_cast<std::size_t>(scenario)]) {
        if (cap == view.cap) viewer.offer(scenario, frame);
    }
}

void Session::frames(FrameSet set) {
    const std::lock_guard lock(frames_mutex_);
    const auto index = static_cast<std::size_t>(set.scenario);
    arrived_[index] = std::move(set);
    if (std::exchange(packing_posted_, true)) return;
    packer_->post([this] { pack_frames(); });
}

void Session::pack_frames() {
    std::array<std::optional<FrameSet>, Scenarios::max_count> arrived;
    {
        const std::lock_guard lock(frames_mutex_);
        arrived.swap(arrived_);
        packing_posted_ = false;
    }
    std::array<std::optional<Packed>, Scenarios::max_count> packed;
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (!arrived[i]) continue;
        packed[i].emplace();
        std::map<twin::FramePtr, Bytes> once;
        for (const auto& [cap, frame] : arrived[i]->frames) {
            Bytes& bytes = once[frame];
            if (!bytes) bytes = std::make_shared<const std::string>(twin::encode(*frame, i));
            packed[i]->emplace_back(cap, bytes);
        }
    }
    const std::lock_guard lock(frames_mutex_);
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (packed[i]) packed_[i] = std::move(packed[i]);
    }
    if (std::exchange(delivery_posted_, true)) return;
    thread_.post([this] { deliver_frames(); });
}

void Session::deliver_frames() {
    std::array<std::optional<Packed>, Scenarios::max_count> packed;
    {
        const std::lock_guard lock(frames_mutex_);
        packed.swap(packed_);
        delivery_posted_ = false;
    }
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (!packed[i]) continue;
        newest_[i] = std::move(*packed[i]);
        for (const auto& [viewer, view] : viewers_) {
            if (view.looks[i]) offer_newest(*viewer, view, i);
        }
    }
}

void Session::broadcast(const json& message) {
    const auto text = std::make_shared<const std::string>(to_text(message));
    for (const auto& [viewer, view] : viewers_) viewer->send(text);
}

void Session::state(int scenario, json state) {
    thread_.post([this, scenario, text = message_text("state", std::move(state))] {
        states_[static_cast<std::size_t>(scenario)] = text;
        for (const auto& [viewer, view] : viewers_) viewer->send(text);
    });
}

void Session::setup(int scenario, json setup) {
    thread_.post([this, scenario, text = message_text("setup", std::move(setup))] {
        setups_[static_cast<std::size_t>(scenario)] = text;
        for (const auto& [viewer, view] : viewers_) viewer->send(text);
    });
    setups_changed_();
}

void Session::calibration(json status) {
    thread_.post([this, text = message_text("calibration", std::move(status))] {
        calibration_ = text;
        for (const auto& [viewer, view] : viewers_) viewer->send(text);
    });
}

void Session::alerts(json status) {
    thread_.post([this, text = message_text("alerts", std::move(status))] {
        alerts_ = text;
        for (const auto& [viewer, view] : viewers_) viewer->send(text);
    });
}

void Session::depth_averaged(int scenario, json status) {
    thread_.post([this, scenario, text = message_text("depth_averaged", std::move(status))] {
        depth_averaged_[static_cast<std::size_t>(scenario)] = text;
        for (const auto& [viewer, view] : viewers_) viewer->send(text);
    });
}

void Session::alerts(int scenario, RunAlerts alerts) {
    thread_.post([this, scenario, alerts = std::move(alerts)] {
        if (on_alerts_) on_alerts_(scenario, alerts);
    });
}

void Session::done(int scenario, const std::string& by, const std::string& sentence) {
    thread_.post([this, scenario, by, sentence] {
        broadcast({{"type", "done"}, {"scenario", Scenarios::name_of(scenario)}, {"by", by}, {"done", sentence}});
    });
}

void Session::scenarios(std::vector<std::string> names) {
    thread_.post([this, names = std::move(names)] {
        names_ = names;
        for (int i = 0; i < Scenarios::max_count; ++i) {
            if (std::find(names.begin(), names.end(), Scenarios::name_of(i)) != names.end()) continue;
            states_[i] = setups_[i] = depth_averaged_[i] = nullptr;
            newest_[i] = {};
        }
        broadcast({{"type", "scenarios"}, {"scenarios", names}});
    });
    setups_changed_();
}

void Session::people_changed() {
    people_untold_ = true;
    const auto now = Clock::now();
    if (now - people_told_ >= people_interval()) tell_people(now);
    arm_tick();
}

/// With many people the list is long and has many recipients, so it is sent less often.
Clock::duration Session::people_interval() const {
    return tick_time * std::max<std::size_t>(1, viewers_.size() / crowd);
}

void Session::tell_people(Clock::time_point now) {
    json message = people_.to_json();
    message["type"] = "people";
    broadcast(message);
    people_untold_ = false;
    people_told_ = now;
}

void Session::tick() {
    ticking_ = false;
    const auto now = Clock::now();
    if (people_.tick(now)) people_untold_ = true;
    if (people_untold_ && now - people_told_ >= people_interval()) tell_people(now);
    arm_tick();
}

void Session::arm_tick() {
    if (ticking_ || (!people_untold_ && !people_.waiting())) return;
    ticking_ = true;
    thread_.tick_after(tick_time);
}

}  // namespace talus::serve
