#include "core/copied.hpp"

#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace talus {
namespace {

struct Node {
    std::string text;
    Copied<Node> next;
};

TEST(Copied, is_copied_with_its_owner) {
    Node first{"a", std::make_unique<Node>()};
    first.next->text = "b";
    const Node copy = first;
    first.next->text = "c";
    EXPECT_EQ(copy.next->text, "b");
    EXPECT_NE(copy.next.get(), first.next.get());
    first = copy;
    EXPECT_EQ(first.next->text, "b");
    EXPECT_NE(copy.next.get(), first.next.get());
}

TEST(Copied, may_be_none_and_is_moved_as_a_pointer) {
    Copied<Node> none;
    const Copied<Node> copy = none;
    EXPECT_FALSE(copy);
    none = std::make_unique<Node>(Node{"a", {}});
    const Node* const there = none.get();
    const Copied<Node> moved = std::move(none);
    EXPECT_EQ(moved.get(), there);
    EXPECT_EQ((*moved).text, "a");
    none = copy;
    EXPECT_FALSE(none);
}

}  // namespace
}  // namespace talus
