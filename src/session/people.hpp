#pragma once

#include <array>
#include <chrono>
#include <list>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "messages/messages.hpp"
#include "session/role.hpp"

namespace talus::session {

struct Person {
    std::string id, name, colour;
    Role role = Role::viewer;
    std::optional<std::array<double, 3>> mark;  ///< what the person points at, local position, m
    bool away = false;                          ///< the connection is lost; the person comes back or is removed
    /// Shows that a request or a connection is this person's; never told to anybody else. Empty: shows nothing.
    std::string secret{};
};

/// What the body of `POST /api/control` wants: request, release, grant or decline. Errors: none of these, another key.
[[nodiscard]] Result<std::string> read_control(const nlohmann::json& wanted);

/// Who is in the session, and which controller has control. Does not depend on connections; time is an argument.
class People {
  public:
    using Time = std::chrono::steady_clock::time_point;
    /// How long the holder of control may leave a request unanswered.
    static constexpr std::chrono::seconds answer_time{10};
    /// Time for which a person whose connection broke keeps place and control, unless it is requested.
    static constexpr std::chrono::seconds return_time{3};

    /// `former`: the secret that the connection had before it broke; empty or unknown: a new person. Every connection
    /// gets a secret of its own. The first controller has control.
    const Person& join(Role role, const std::string& name, const std::string& former, Time now);
    void leave(const std::string& id, Time now);
    void rename(const std::string& id, const std::string& name);
    void set_mark(const std::string& id, std::optional<std::array<double, 3>> mark);

    /// `what`: as of read_control(). Errors: no such person or not a controller, not the holder, no
    /// request, another request is open.
    [[nodiscard]] Status control(const std::string& what, const std::string& id, Time now);
    /// Whether `id` (empty: a program without a WebSocket) may change something now. The error says who has control.
    [[nodiscard]] Status may_act(const std::string& id) const;

    /// Applies changes that are due with time. True: something has changed.
    bool tick(Time now);
    /// Whether a change is pending that becomes due with time.
    [[nodiscard]] bool waiting() const;

    [[nodiscard]] const Person* find(const std::string& id) const;
    /// Who has this secret and is here; nullptr: nobody.
    [[nodiscard]] const Person* whose(const std::string& secret) const;
    [[nodiscard]] std::size_t count() const;
    [[nodiscard]] messages::PeopleMessage message() const;

  private:
    struct Member : Person {
        Time left{};
    };
    struct ControlRequest {
        std::string id;
        Time since;
    };
    [[nodiscard]] Member* member(const std::string& id);
    [[nodiscard]] const char* free_colour() const;
    void pass_control();

    std::list<Member> members_;  // in the order of joining; a list: references last
    std::string holder_;         // id; empty: nobody
    std::optional<ControlRequest> request_;
    std::uint64_t joined_ = 0;
};

}  // namespace talus::session
