#include "session/people.hpp"

#include <map>

#include <gtest/gtest.h>

namespace talus::session {
namespace {

using std::chrono::seconds;

class PeopleTest : public ::testing::Test {
  protected:
    std::string join(Role role, const std::string& name, const std::string& former = "") {
        const Person& who = people.join(role, name, former.empty() ? "" : secrets[former], now);
        secrets[who.id] = who.secret;
        return who.id;
    }
    [[nodiscard]] std::string holder() const { return people.message().controller.value_or(""); }
    Status control(const char* what, const std::string& id) { return people.control(what, id, now); }
    void pass(People::Time::duration time) {
        now += time;
        people.tick(now);
    }

    People people;
    std::map<std::string, std::string> secrets;  ///< by id, of the last connection
    People::Time now{seconds(1000)};
};

TEST_F(PeopleTest, the_first_controller_has_control) {
    const std::string eye = join(Role::viewer, "Eye");
    EXPECT_EQ(holder(), "");
    EXPECT_TRUE(people.may_act(""));
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    EXPECT_EQ(holder(), ada);
    EXPECT_TRUE(people.may_act(ada));
    EXPECT_FALSE(people.may_act(bo));
    EXPECT_FALSE(people.may_act(eye));
    EXPECT_FALSE(people.may_act("p99"));
    EXPECT_NE(people.may_act("").error().message.find("Ada"), std::string::npos);
}

TEST_F(PeopleTest, control_is_granted_or_declined) {
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    const std::string cy = join(Role::controller, "Cy"), eye = join(Role::viewer, "Eye");
    EXPECT_FALSE(control("request", eye));
    EXPECT_FALSE(control("grant", ada));
    EXPECT_TRUE(control("request", bo));
    EXPECT_EQ(people.message().request->name, "Bo");
    EXPECT_FALSE(control("request", cy));
    EXPECT_FALSE(control("grant", bo));
    EXPECT_TRUE(control("decline", ada));
    EXPECT_EQ(holder(), ada);
    EXPECT_FALSE(people.message().request);
    EXPECT_TRUE(control("request", cy));
    EXPECT_TRUE(control("grant", ada));
    EXPECT_EQ(holder(), cy);
}

TEST_F(PeopleTest, an_unanswered_request_passes_control_after_ten_seconds) {
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    ASSERT_TRUE(control("request", bo));
    pass(std::chrono::milliseconds(9900));
    EXPECT_EQ(holder(), ada);
    EXPECT_TRUE(people.waiting());
    ASSERT_TRUE(control("request", bo));  // asking again does not begin anew
    pass(std::chrono::milliseconds(200));
    EXPECT_EQ(holder(), bo);
    EXPECT_FALSE(people.waiting());
}

TEST_F(PeopleTest, release_gives_control_to_whom_asks_or_to_nobody) {
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    ASSERT_TRUE(control("release", ada));
    EXPECT_EQ(holder(), "");
    EXPECT_TRUE(people.may_act(""));
    EXPECT_FALSE(people.may_act(bo));
    ASSERT_TRUE(control("request", bo));
    EXPECT_EQ(holder(), bo);
    ASSERT_TRUE(control("request", ada));
    ASSERT_TRUE(control("release", bo));
    EXPECT_EQ(holder(), ada);
}

TEST_F(PeopleTest, the_next_controller_follows_a_holder_who_has_gone) {
    const std::string ada = join(Role::controller, "Ada");
    join(Role::viewer, "Eye");
    const std::string bo = join(Role::controller, "Bo");
    people.leave(ada, now);
    EXPECT_FALSE(people.may_act(bo));
    EXPECT_FALSE(people.may_act(""));
    pass(People::return_time);
    EXPECT_EQ(holder(), bo);
    people.leave(bo, now);
    pass(People::return_time);
    EXPECT_EQ(holder(), "");
    EXPECT_EQ(people.count(), 1U);
}

TEST_F(PeopleTest, whom_asks_need_not_wait_for_a_holder_who_has_gone) {
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    ASSERT_TRUE(control("request", bo));
    people.leave(ada, now);
    EXPECT_EQ(holder(), bo);
}

TEST_F(PeopleTest, who_comes_back_in_time_is_the_same_person) {
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    const std::string colour = people.find(ada)->colour;
    people.leave(ada, now);
    EXPECT_EQ(people.find(ada), nullptr);
    pass(seconds(2));
    EXPECT_EQ(join(Role::controller, "Ada", ada), ada);
    EXPECT_EQ(people.find(ada)->colour, colour);
    pass(seconds(5));
    EXPECT_EQ(holder(), ada);
    // Neither somebody who is there can be replaced, nor a role be changed, nor a place be had after it is given up.
    EXPECT_NE(join(Role::controller, "Mallory", bo), bo);
    people.leave(bo, now);
    EXPECT_NE(join(Role::viewer, "Mallory", bo), bo);
    pass(seconds(5));
    EXPECT_NE(join(Role::controller, "Bo", bo), bo);
}

TEST_F(PeopleTest, a_secret_shows_who_is_who_and_an_id_does_not) {
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    ASSERT_EQ(people.whose(secrets[ada]), people.find(ada));
    EXPECT_EQ(people.whose(ada), nullptr);
    EXPECT_EQ(people.whose(""), nullptr);
    EXPECT_NE(secrets[ada], secrets[bo]);
    EXPECT_EQ(nlohmann::json(people.message()).dump().find(secrets[ada]), std::string::npos);
    const std::string first = secrets[ada];
    people.leave(ada, now);
    EXPECT_EQ(people.whose(first), nullptr) << "nobody acts in the name of who has gone";
    EXPECT_NE(people.join(Role::controller, "Mallory", ada, now).id, ada) << "an id brings nobody back";
    EXPECT_EQ(join(Role::controller, "Ada", ada), ada);
    EXPECT_EQ(people.whose(first), nullptr) << "each connection has a secret of its own";
    EXPECT_EQ(people.whose(secrets[ada]), people.find(ada));
}

TEST_F(PeopleTest, a_request_ends_with_who_made_it) {
    const std::string ada = join(Role::controller, "Ada"), bo = join(Role::controller, "Bo");
    ASSERT_TRUE(control("request", bo));
    people.leave(bo, now);
    EXPECT_FALSE(people.message().request);
    pass(seconds(20));
    EXPECT_EQ(holder(), ada);
}

TEST_F(PeopleTest, names_are_tidied_and_colours_differ) {
    const std::string ada = join(Role::controller, "  Ada\n\x01  ");
    const std::string none = join(Role::viewer, "");
    const std::string bad = join(Role::viewer, "\xff\xfe");
    const std::string longer = join(Role::viewer, std::string(500, 'x'));
    EXPECT_EQ(people.find(ada)->name, "Ada");
    EXPECT_EQ(people.find(none)->name, "Viewer 2");
    EXPECT_EQ(people.find(bad)->name, "\xef\xbf\xbd\xef\xbf\xbd");
    EXPECT_EQ(people.find(longer)->name.size(), 40U);
    EXPECT_NE(people.find(ada)->colour, people.find(none)->colour);
    people.set_mark(ada, std::array<double, 3>{1, 2, 3});
    EXPECT_EQ(people.message().people[0].mark, (std::array<double, 3>{1, 2, 3}));
}

}  // namespace
}  // namespace talus::session
