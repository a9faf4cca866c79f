#pragma once

#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "session/page_api.hpp"
#include "support/value_of.hpp"
#include "twin/twin_fixtures.hpp"

namespace talus::session {

/// The requests of a page to a session in its own worker, which has one thread for all.
class PageOfASession : public ::testing::Test {
  protected:
    PageAnswer ask(const std::string& method, const std::string& target, const std::string& body = "") {
        return api_.answer(method, target, body, ann_, now_);
    }

    std::shared_ptr<const scene::Scene> scene_ = std::make_shared<const scene::Scene>(twin::test::channel_scene());
    Clock::time_point time_{std::chrono::seconds(1000)};
    Now now_ = [this] { return time_ += std::chrono::milliseconds(1); };
    std::unique_ptr<Session> session_ = talus::test::value_of(Session::open({scene_, {}, "test"}));
    std::string ann_ = session_->join(Role::controller, "Ann", time_);
    PageApi api_{*session_, *scene_, std::nullopt};
};

}  // namespace talus::session
