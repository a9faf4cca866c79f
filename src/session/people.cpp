#include "session/people.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/try.hpp"
#include "session/json_text.hpp"
#include "session/secret.hpp"
#include "twin/json_keys.hpp"

namespace talus::session {
namespace {

constexpr std::size_t longest_person_name = 40;

// Okabe and Ito (2008), Color Universal Design: told apart by colour-blind readers too.
constexpr std::array<const char*, 7> colours = {"#e69f00", "#56b4e9", "#009e73", "#f0e442",
                                                "#0072b2", "#d55e00", "#cc79a7"};

}  // namespace

Result<std::string> read_control(const nlohmann::json& wanted) {
    if (wanted.is_object()) TALUS_TRY(twin::check_keys(wanted, {"do", "secret"}));
    std::string what = text_at(wanted, "do");
    if (what == "request" || what == "release" || what == "grant" || what == "decline") return what;
    return Error{fmt::format("do = \"{}\"; it is request, release, grant or decline", tidy_name(what, 30))};
}

People::Member* People::member(const std::string& id) {
    const auto found = std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.id == id; });
    return found == members_.end() ? nullptr : &*found;
}

const Person* People::find(const std::string& id) const {
    const auto found =
        std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.id == id && !m.away; });
    return found == members_.end() ? nullptr : &*found;
}

const Person* People::whose(const std::string& secret) const {
    const auto found = std::find_if(members_.begin(), members_.end(),
                                    [&](const Member& m) { return !m.away && same_secret(secret, m.secret); });
    return found == members_.end() ? nullptr : &*found;
}

std::size_t People::count() const {
    return static_cast<std::size_t>(
        std::count_if(members_.begin(), members_.end(), [](const Member& m) { return !m.away; }));
}

const char* People::free_colour() const {
    std::array<int, colours.size()> used{};
    for (const Member& m : members_) {
        for (std::size_t i = 0; i < colours.size(); ++i) used[i] += m.colour == colours[i] ? 1 : 0;
    }
    return colours[static_cast<std::size_t>(std::min_element(used.begin(), used.end()) - used.begin())];
}

const Person& People::join(Role role, const std::string& name, const std::string& former, Time) {
    const auto left = std::find_if(members_.begin(), members_.end(), [&](const Member& m) {
        return m.away && m.role == role && same_secret(former, m.secret);
    });
    Member* known = nullptr;
    if (left != members_.end()) {
        known = &*left;
        known->away = false;
    } else {
        ++joined_;
        Member fresh;
        fresh.id = fmt::format("p{}", joined_);
        fresh.name = fmt::format("{} {}", role == Role::controller ? "Controller" : "Viewer", joined_);
        fresh.colour = free_colour();
        fresh.role = role;
        members_.push_back(fresh);
        known = &members_.back();
    }
    const Result<std::string> secret = random_token();
    known->secret = secret ? *secret : "";
    rename(known->id, name);
    if (role == Role::controller && holder_.empty()) holder_ = known->id;
    return *known;
}

void People::leave(const std::string& id, Time now) {
    Member* who = member(id);
    if (who == nullptr) return;
    who->away = true;
    who->left = now;
    who->mark.reset();
    if (request_ && request_->id == id) request_.reset();
    if (holder_ == id && request_) pass_control();
}

void People::rename(const std::string& id, const std::string& name) {
    Member* who = member(id);
    const std::string tidy = tidy_name(name, longest_person_name);
    if (who != nullptr && !tidy.empty()) who->name = tidy;
}

void People::set_mark(const std::string& id, std::optional<std::array<double, 3>> mark) {
    if (Member* who = member(id)) who->mark = mark;
}

/// To the requester, otherwise to the controller present for the longest time, otherwise to nobody.
void People::pass_control() {
    const std::string former = holder_;
    holder_.clear();
    if (request_) {
        holder_ = request_->id;
    } else {
        for (const Member& m : members_) {
            if (m.role == Role::controller && !m.away && m.id != former) {
                holder_ = m.id;
                break;
            }
        }
    }
    request_.reset();
}

Status People::control(const std::string& what, const std::string& id, Time now) {
    const Person* who = find(id);
    if (who == nullptr) return Error{fmt::format("person = \"{}\" is not in this session", id)};
    if (who->role != Role::controller)
        return Error{who->name + " came with the link for viewers and cannot have control"};
    if (what == "request") {
        if (holder_ == id) return {};
        if (holder_.empty()) {
            holder_ = id;
            return {};
        }
        if (request_ && request_->id != id) return Error{find(request_->id)->name + " has already asked for control"};
        if (!request_) request_ = ControlRequest{id, now};
        return {};
    }
    if (holder_ != id) return Error{who->name + " does not have control"};
    if (what == "release") {
        const bool asked = request_.has_value();
        if (asked) {
            pass_control();
        } else {
            holder_.clear();
        }
        return {};
    }
    if (!request_) return Error{"nobody has asked for control"};
    if (what == "grant") {
        pass_control();
    } else {
        request_.reset();
    }
    return {};
}

Status People::may_act(const std::string& id) const {
    if (!id.empty() && find(id) == nullptr) return Error{fmt::format("person = \"{}\" is not in this session", id)};
    if (holder_ == id) return {};
    if (holder_.empty()) return Error{"nobody has control; ask for it"};
    const Person* holder = find(holder_);
    return Error{fmt::format("{} has control; ask for it", holder ? holder->name : "somebody who was here just now")};
}

bool People::tick(Time now) {
    bool changed = false;
    if (request_ && now - request_->since >= answer_time) {
        pass_control();
        changed = true;
    }
    for (auto it = members_.begin(); it != members_.end();) {
        if (it->away && now - it->left >= return_time) {
            if (holder_ == it->id) {
                pass_control();
                changed = true;
            }
            it = members_.erase(it);
        } else {
            ++it;
        }
    }
    return changed;
}

bool People::waiting() const {
    return request_.has_value() ||
           std::any_of(members_.begin(), members_.end(), [](const Member& m) { return m.away; });
}

messages::PeopleMessage People::message() const {
    messages::PeopleMessage all{};
    for (const Member& m : members_) {
        if (m.away) continue;
        all.people.push_back(
            {.id = m.id, .name = m.name, .role = role_name(m.role), .colour = m.colour, .mark = m.mark});
    }
    if (find(holder_) != nullptr) all.controller = holder_;
    if (request_) all.request = {.id = request_->id, .name = find(request_->id)->name};
    return all;
}

}  // namespace talus::session
