#include "session/session.hpp"

#include <algorithm>
#include <atomic>

#include "core/try.hpp"
#include "session/secret.hpp"

namespace talus::session {

using nlohmann::json;

/// Keeps what a person is sent until it is asked for.
struct Session::Guest final : Viewer {
    void send(Bytes text) override { events.push_back(std::move(text)); }
    void offer(int scenario, Bytes frame) override { frames[scenario] = std::move(frame); }
    void set_rate(double) override {}  // of those who ask, the rate at which they do
    void dismiss(Bytes last) override { send(std::move(last)); }

    std::vector<Bytes> events;
    std::map<int, Bytes> frames;
};

Session::~Session() = default;

Result<std::unique_ptr<Session>> Session::open(Setup setup) {
    TALUS_ASSIGN(auto first, twin::Scenario::open(setup.scene, std::move(setup.options)));
    Room::Settings room;
    TALUS_ASSIGN(room.id, random_token());
    room.program = std::move(setup.program);
    room.title = setup.scene->spec.scene.title;
    room.links = [](Role) { return messages::Session::Links{}; };  // nobody can be led here
    std::unique_ptr<Session> made(new Session());
    room.watching = [&session = *made](const std::vector<Audience>& audience) {
        session.scenarios_->set_audience(audience);
    };
    made->room_ = std::make_unique<Room>(std::move(room));
    made->scenarios_ = std::make_unique<Scenarios>(std::move(first), static_cast<Watcher&>(*made),
                                                   [&work = made->work_](Work task, std::function<void()> then) {
                                                       work.emplace_back(std::move(task), std::move(then));
                                                   });
    return made;
}

std::string Session::join(Role role, const std::string& name, Clock::time_point now) {
    auto guest = std::make_unique<Guest>();
    std::string id = room_->join(*guest, role, name, "", now).id;
    guests_[id] = std::move(guest);
    return id;
}

void Session::leave(const std::string& id, Clock::time_point now) {
    const auto found = guests_.find(id);
    if (found == guests_.end()) return;
    room_->leave(*found->second, now);
    guests_.erase(found);
}

bool Session::receive(const std::string& id, std::string_view text, Clock::time_point now) {
    const auto found = guests_.find(id);
    return found != guests_.end() && room_->receive(*found->second, text, now);
}

Status Session::control(const std::string& what, const std::string& id, Clock::time_point now) {
    TALUS_TRY(room_->people().control(what, id, now));
    room_->people_changed(now);
    return {};
}

Result<std::string> Session::actor(const std::string& id) {
    TALUS_TRY(room_->people().may_act(id));
    const Person* who = room_->people().find(id);
    return who != nullptr ? who->name : "a program";
}

void Session::act(const std::string& id, const std::string& scenario, const json& action, const Answered& answered) {
    const auto by = actor(id);
    if (!by) return answered(refusal(Outcome::not_now, by.error().message));
    session::act(*scenarios_, scenario, action, *by, answered);
}

void Session::copy(const std::string& id, const json& wanted, const Answered& answered) {
    const auto by = actor(id);
    if (!by) return answered(refusal(Outcome::not_now, by.error().message));
    session::copy(*scenarios_, wanted, *by, answered);
}

Reply Session::end(const std::string& id, const std::string& scenario) {
    if (const auto by = actor(id); !by) return refusal(Outcome::not_now, by.error().message);
    return session::end(*scenarios_, scenario);
}

Reply Session::ask(const std::string& scenario, const std::string& question, const Arguments& arguments) {
    const auto found = std::find_if(questions().begin(), questions().end(),
                                    [&](const Question& known) { return known.name == question; });
    if (found == questions().end()) return refusal(Outcome::unknown, "there is no question " + question);
    return session::ask(*scenarios_, scenario, *found, arguments)();
}

Reply Session::turn_depth_averaged(const std::string& id, const json& wanted) {
    if (const auto by = actor(id); !by) return refusal(Outcome::not_now, by.error().message);
    const Result<bool> on = read_switch(wanted);
    if (!on) return refusal(Outcome::wrong, on.error().message);
    depth_averaged_.turn(*on, *scenarios_);
    return reply(switched(*on));
}

Reply Session::depth_averaged(const std::string& scenario, const std::string& question, const Arguments& arguments) {
    const auto index = scenarios_->find(scenario);
    if (!index) return no_scenario(scenario);
    const DepthAveragedResults& results = depth_averaged_.results();
    if (question.empty()) return reply(results.describe(*index));
    const auto time = number_of(arguments, "time_s", 0, 1e9);
    if (!time) return refusal(Outcome::wrong, time.error().message);
    const DepthAveragedResults::Run run = results.result(*index);
    if (!run) return refusal(Outcome::unknown, results.why_none(*index));
    if (question == "comparison") return reply(twin::comparison_with(scenarios_->at(*index), run)());
    constexpr std::string_view layers = "layers/";
    const auto grid = run->layer(question.substr(std::min(layers.size(), question.size())), *time);
    if (!grid) return refusal(Outcome::unknown, grid.error().message);
    return {Outcome::done, std::make_shared<const std::string>(twin::encode_grid(*grid)), true};
}

std::optional<std::vector<twin::RunFile>> Session::files(const std::string& scenario) const {
    const auto index = scenarios_->find(scenario);
    if (!index) return {};
    return twin::page_files_of(scenarios_->at(*index));
}

std::optional<Clock::time_point> Session::advance(const Now& now, Clock::duration budget) {
    const Clock::time_point begin = now();
    room_->tick(begin);
    const std::atomic<bool> stop = false;
    while (true) {
        if (!work_.empty()) {
            const auto [work, then] = std::move(work_.front());
            work_.pop_front();
            work(stop);
            then();
        }
        const auto next = scenarios_->work(now);
        if (std::exchange(setups_changed_, false)) depth_averaged_.look(*scenarios_);
        const bool computes = depth_averaged_.step(now());
        const Clock::time_point ended = now();
        const bool more = computes || !work_.empty() || (next && *next <= ended);
        if (more && ended - begin < budget) continue;
        if (more) return ended;
        if (!room_->waiting()) return next;
        return next ? std::min(*next, ended + Room::tick_time) : ended + Room::tick_time;
    }
}

std::vector<Bytes> Session::events(const std::string& id) {
    const auto found = guests_.find(id);
    return found == guests_.end() ? std::vector<Bytes>() : std::exchange(found->second->events, {});
}

std::vector<Bytes> Session::frames(const std::string& id) {
    std::vector<Bytes> frames;
    const auto found = guests_.find(id);
    if (found == guests_.end()) return frames;
    for (auto& [scenario, frame] : std::exchange(found->second->frames, {})) frames.push_back(std::move(frame));
    return frames;
}

void Session::state(int scenario, json state) {
    room_->keep(Kept::state, scenario, message_text(Kept::state, std::move(state)));
}

void Session::setup(int scenario, json told, const twin::Setup& /*setup*/) {
    room_->keep(Kept::setup, scenario, message_text(Kept::setup, std::move(told)));
    setups_changed_ = true;
}

void Session::scenarios(std::vector<std::string> names) {
    room_->scenarios(names);
    setups_changed_ = true;
}

void Session::done(int scenario, const std::string& by, const std::string& sentence) {
    room_->done(scenario, by, sentence);
}

}  // namespace talus::session
