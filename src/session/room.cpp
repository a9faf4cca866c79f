#include "session/room.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "session/json_text.hpp"
#include "twin/json_keys.hpp"

namespace talus::session {
namespace {

using nlohmann::json;

constexpr int protocol_version = 1;
constexpr std::size_t crowd = 50;  // up to this number, people get the list ten times a second; above it, less often

Bytes bytes_of(const json& message) {
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

Bytes message_text(Kept what, json message) {
    constexpr std::array types{"setup", "state", "depth_averaged", "calibration", "alerts", "overlays"};
    message["type"] = types[static_cast<std::size_t>(what)];
    return bytes_of(message);
}

PackedFrames pack(const FrameSet& set) {
    PackedFrames packed;
    std::map<twin::FramePtr, Bytes> once;
    for (const auto& [cap, frame] : set.frames) {
        Bytes& bytes = once[frame];
        if (!bytes) bytes = std::make_shared<const std::string>(twin::encode(*frame, set.scenario));
        packed.emplace_back(cap, bytes);
    }
    return packed;
}

messages::Session Room::describe(Role role) const {
    messages::PeopleMessage people = people_.message();
    return {.protocol = protocol_version,
            .id = settings_.id,
            .program = settings_.program,
            .title = settings_.title,
            .you = {.role = role_name(role)},
            .scenarios = names_,
            .people = std::move(people.people),
            .controller = std::move(people.controller),
            .request = std::move(people.request),
            .links = settings_.links(role)};
}

const Person& Room::join(Viewer& viewer, Role role, const std::string& name, const std::string& former,
                         Clock::time_point now) {
    const Person& who = people_.join(role, name, former, now);
    viewers_[&viewer].person = who.id;
    const messages::You you{
        .id = who.id, .name = who.name, .role = role_name(role), .colour = who.colour, .secret = who.secret};
    viewer.send(bytes_of(messages::HelloMessage{.protocol = protocol_version, .you = you, .session = describe(role)}));
    for (const auto& messages : kept_) {
        for (const auto& [what, text] : messages) viewer.send(text);
    }
    people_changed(now);
    return who;
}

void Room::leave(Viewer& viewer, Clock::time_point now) {
    const auto found = viewers_.find(&viewer);
    if (found == viewers_.end()) return;
    people_.leave(found->second.person, now);
    viewers_.erase(found);
    update_audience();
    people_changed(now);
}

void Room::dismiss_all() {
    const auto viewers = std::exchange(viewers_, {});
    for (const auto& [viewer, view] : viewers) viewer->dismiss(bytes_of(messages::EndedMessage{}));
}

bool Room::receive(Viewer& viewer, std::string_view text, Clock::time_point now) {
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
        people_changed(now);
        return true;
    }
    if (*type == "name") {
        if (!only({"type", "name"}) || !message.contains("name") || !message["name"].is_string()) return false;
        people_.rename(view.person, message["name"].get<std::string>());
        people_changed(now);
        return true;
    }
    return false;
}

bool Room::set_view(Viewer& viewer, View& view, const json& message) {
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

/// If this changes which frames are needed, the scenarios make one immediately.
void Room::update_audience() {
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
    settings_.watching(std::move(audience));
}

void Room::offer_newest(Viewer& viewer, const View& view, int scenario) {
    for (const auto& [cap, frame] : newest_[static_cast<std::size_t>(scenario)]) {
        if (cap == view.cap) viewer.offer(scenario, frame);
    }
}

void Room::deliver(int scenario, PackedFrames frames) {
    const auto index = static_cast<std::size_t>(scenario);
    newest_[index] = std::move(frames);
    for (const auto& [viewer, view] : viewers_) {
        if (view.looks[index]) offer_newest(*viewer, view, scenario);
    }
}

void Room::tell(const Bytes& text) {
    for (const auto& [viewer, view] : viewers_) viewer->send(text);
}

void Room::tell(const json& message) {
    tell(bytes_of(message));
}

void Room::keep(Kept what, int scenario, const Bytes& text) {
    kept_[static_cast<std::size_t>(scenario)][what] = text;
    tell(text);
}

void Room::done(int scenario, const std::string& by, const std::string& sentence) {
    tell(messages::DoneMessage{.scenario = Scenarios::name_of(scenario), .by = by, .done = sentence});
}

void Room::scenarios(const std::vector<std::string>& names) {
    names_ = names;
    for (int i = 0; i < Scenarios::max_count; ++i) {
        if (std::find(names.begin(), names.end(), Scenarios::name_of(i)) != names.end()) continue;
        kept_[i].clear();
        newest_[i] = {};
    }
    tell(messages::ScenariosMessage{.scenarios = names});
}

void Room::people_changed(Clock::time_point now) {
    people_untold_ = true;
    if (now - people_told_ >= people_interval()) tell_people(now);
}

/// With many people the list is long and has many recipients, so it is sent less often.
Clock::duration Room::people_interval() const {
    return tick_time * std::max<std::size_t>(1, viewers_.size() / crowd);
}

void Room::tell_people(Clock::time_point now) {
    tell(people_.message());
    people_untold_ = false;
    people_told_ = now;
}

void Room::tick(Clock::time_point now) {
    if (people_.tick(now)) people_untold_ = true;
    if (people_untold_ && now - people_told_ >= people_interval()) tell_people(now);
}

}  // namespace talus::session
