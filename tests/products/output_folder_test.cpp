#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "products/products.hpp"
#include "support/fixtures.hpp"

namespace talus::products {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::StartsWith;

class OutputFolders : public testing::Test {
  protected:
    /// What lies in the parent folder.
    [[nodiscard]] std::vector<std::string> listing() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(parent_.path())) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }
    fs::path make_result(const std::string& name, const std::string& manifest = R"({"program": "talus"})") {
        fs::create_directory(parent_.path() / name);
        test::write_text(parent_.file(name + "/manifest.json"), manifest);
        return parent_.path() / name;
    }
    static std::string refusal(const fs::path& path, bool force) {
        const auto folder = OutputFolder::create(path, force);
        return folder.ok() ? "accepted" : folder.error().message;
    }
    TemporaryFolder parent_;
};

TEST_F(OutputFolders, name_appears_only_when_committed) {
    {
        auto folder = OutputFolder::create(parent_.path() / "out", false);
        ASSERT_TRUE(folder.ok()) << folder.error().message;
        EXPECT_EQ(folder->path().parent_path(), parent_.path()) << "on the same file system";
        EXPECT_THAT(folder->path().filename().string(), StartsWith("."));
        test::write_text((folder->path() / "a.txt").string(), "a");
        EXPECT_FALSE(fs::exists(parent_.path() / "out"));
        ASSERT_TRUE(folder->commit().ok());
    }
    EXPECT_EQ(test::read_text(parent_.path() / "out" / "a.txt"), "a");
    EXPECT_EQ(listing(), std::vector<std::string>{"out"});
}

TEST_F(OutputFolders, abandoned_one_leaves_nothing) {
    {
        auto folder = OutputFolder::create(parent_.path() / "out", false);
        ASSERT_TRUE(folder.ok());
        const OutputFolder moved = std::move(folder).value();
        test::write_text((moved.path() / "a.txt").string(), "a");
        EXPECT_TRUE(fs::exists(moved.path()));
    }
    EXPECT_TRUE(listing().empty());
}

TEST_F(OutputFolders, what_killed_runs_of_the_same_output_left_is_deleted_by_the_next) {
    for (const char* name : {".out.unfinished-4711-0", ".out.unfinished-1-12", ".other.unfinished-4711-0",
                             ".out.unfinished-notes", ".out.replaced-4711-0"}) {
        fs::create_directory(parent_.path() / name);
        test::write_text(parent_.file(std::string(name) + "/a.txt"), "a");
    }
    const auto running = OutputFolder::create(parent_.path() / "out", false);
    ASSERT_TRUE(running) << running.error().message;
    test::write_text((running->path() / "a.txt").string(), "a");
    const auto next = OutputFolder::create(parent_.path() / "out", false);
    ASSERT_TRUE(next) << next.error().message;
    EXPECT_NE(next->path(), running->path());
    EXPECT_TRUE(fs::exists(running->path() / "a.txt")) << "that of a run that goes on stays";
    std::vector<std::string> expected{".other.unfinished-4711-0", ".out.replaced-4711-0", ".out.unfinished-notes",
                                      running->path().filename(), next->path().filename()};
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(listing(), expected);
}

TEST_F(OutputFolders, existing_one_is_refused_without_force) {
    const fs::path out = make_result("out");
    EXPECT_EQ(refusal(out, false), out.string() +
                                       ": is already there; name another output folder, or replace an earlier result "
                                       "with --force");
    EXPECT_EQ(refusal(out.string() + "/", false), refusal(out, false));
    EXPECT_EQ(listing(), std::vector<std::string>{"out"}) << "nothing half-made stays behind";
}

TEST_F(OutputFolders, force_replaces_an_earlier_result_at_the_end) {
    const fs::path out = make_result("out");
    test::write_text((out / "old.txt").string(), "old");
    auto folder = OutputFolder::create(out, true);
    ASSERT_TRUE(folder.ok()) << folder.error().message;
    EXPECT_TRUE(fs::exists(out / "old.txt")) << "still there while the new one is made";
    test::write_text((folder->path() / "new.txt").string(), "new");
    ASSERT_TRUE(folder->commit().ok());
    EXPECT_TRUE(fs::exists(out / "new.txt"));
    EXPECT_FALSE(fs::exists(out / "old.txt"));
    EXPECT_EQ(listing(), std::vector<std::string>{"out"});
}

TEST_F(OutputFolders, force_never_replaces_what_is_no_result) {
    const fs::path plain = parent_.path() / "thesis";
    fs::create_directory(plain);
    test::write_text((plain / "chapter1.txt").string(), "years of work");
    EXPECT_THAT(refusal(plain, true), HasSubstr("is not a result of talus"));
    EXPECT_THAT(refusal(make_result("web", R"({"name": "a web app", "start_url": "/"})"), true),
                HasSubstr("is not a result of talus"));
    EXPECT_THAT(refusal(make_result("broken", "{"), true), HasSubstr("is not a result of talus"));
    EXPECT_THAT(refusal(test::write_text(parent_.file("file"), "text"), true), HasSubstr("is a file, not a folder"));
    EXPECT_TRUE(fs::exists(plain / "chapter1.txt"));
}

TEST_F(OutputFolders, force_accepts_an_empty_folder) {
    fs::create_directory(parent_.path() / "out");
    auto folder = OutputFolder::create(parent_.path() / "out", true);
    ASSERT_TRUE(folder.ok());
    EXPECT_TRUE(folder->commit().ok());
}

TEST_F(OutputFolders, one_that_appears_meanwhile_is_not_overwritten) {
    auto folder = OutputFolder::create(parent_.path() / "out", false);
    ASSERT_TRUE(folder.ok());
    test::write_text((make_result("out") / "other.txt").string(), "of another run");
    EXPECT_FALSE(folder->commit().ok());
    EXPECT_TRUE(fs::exists(parent_.path() / "out" / "other.txt"));

    auto forced = OutputFolder::create(parent_.path() / "thesis", true);
    ASSERT_TRUE(forced.ok());
    fs::create_directory(parent_.path() / "thesis");
    test::write_text(parent_.file("thesis/chapter1.txt"), "years of work");
    EXPECT_FALSE(forced->commit().ok());
    EXPECT_TRUE(fs::exists(parent_.path() / "thesis" / "chapter1.txt"));
}

TEST_F(OutputFolders, two_runs_at_once_do_not_share_a_temporary_folder) {
    const auto first = OutputFolder::create(parent_.path() / "out", false);
    const auto second = OutputFolder::create(parent_.path() / "out", false);
    ASSERT_TRUE(first.ok() && second.ok());
    EXPECT_NE(first->path(), second->path());
}

TEST_F(OutputFolders, link_is_followed) {
    const fs::path out = make_result("real");
    fs::create_directory_symlink(out, parent_.path() / "latest");
    EXPECT_THAT(refusal(parent_.path() / "latest", false), HasSubstr("is already there"));
    auto folder = OutputFolder::create(parent_.path() / "latest", true);
    ASSERT_TRUE(folder.ok());
    test::write_text((folder->path() / "new.txt").string(), "new");
    ASSERT_TRUE(folder->commit().ok());
    EXPECT_TRUE(fs::exists(out / "new.txt"));
    EXPECT_TRUE(fs::is_symlink(parent_.path() / "latest"));
}

TEST_F(OutputFolders, missing_folders_above_it_are_made_and_left_only_with_a_result) {
    const fs::path deep = parent_.path() / "a" / "b" / "c";
    {
        auto folder = OutputFolder::create(deep, false);
        ASSERT_TRUE(folder.ok()) << folder.error().message;
    }
    EXPECT_FALSE(fs::exists(parent_.path() / "a")) << "a run that was given up leaves nothing";
    {
        auto first = OutputFolder::create(deep, false);
        auto second = OutputFolder::create(parent_.path() / "a" / "other", false);
        ASSERT_TRUE(first.ok() && second.ok());
        EXPECT_TRUE(second->commit().ok());
    }
    EXPECT_FALSE(fs::exists(parent_.path() / "a" / "b"));
    EXPECT_TRUE(fs::exists(parent_.path() / "a" / "other")) << "the folder of another result stays";
    auto folder = OutputFolder::create(deep, false);
    ASSERT_TRUE(folder.ok());
    EXPECT_TRUE(folder->commit().ok());
    EXPECT_TRUE(fs::exists(deep));
}

TEST_F(OutputFolders, unwritable_place) {
    (void)test::write_text(parent_.file("file"), "text");
    EXPECT_THAT(refusal(parent_.path() / "file" / "out", false), HasSubstr("is a file, not a folder"));
    EXPECT_THAT(refusal("/proc/talus_out", false), StartsWith("/proc/talus_out: cannot be made in /proc: "));
    EXPECT_EQ(refusal("", false), "no output folder given");
}

}  // namespace
}  // namespace talus::products
