#include "serve/sent_files.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "core/temporary_folder.hpp"
#include "serve/library.hpp"

namespace talus::serve {
namespace {

TEST(SentFiles, give_one_copy_to_all_who_are_sent_a_file_at_a_time) {
    const TemporaryFolder folder;
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream(folder.path() / name, std::ios::binary) << text;
        return folder.path() / name;
    };
    const auto file = write("run.glb", std::string("a\0b", 3)), other = write("maps.nc", "");
    SentFiles files;
    auto first = files.read(file);
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_EQ(**first, std::string("a\0b", 3));
    const auto second = files.read(file), empty = files.read(other);
    ASSERT_TRUE(second && empty);
    EXPECT_EQ(first->get(), second->get());
    EXPECT_EQ(**empty, "");
    EXPECT_EQ(first->use_count(), 2) << "the files themselves hold none";

    const auto none = files.read(folder.path() / "none.tif");
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().message, "none.tif cannot be read back");
}

TEST(Sentences, name_a_file_as_its_user_did_and_no_folder_of_this_machine) {
    EXPECT_EQ(with_name("/tmp/a/upload.part: holds /tmp/a/upload.part", "/tmp/a/upload.part", "dem.zip"),
              "dem.zip: holds dem.zip");
    EXPECT_EQ(with_name("a: b", "a", "aa"), "aa: b") << "a name that holds the path ends, too";
    EXPECT_EQ(without_folder("/tmp/flow-1/run.glb: cannot be written", "/tmp/flow-1"), "run.glb: cannot be written");
    EXPECT_EQ(without_folder("/tmp/flow-1: cannot be made", "/tmp/flow-1"), "its folder: cannot be made");
}

}  // namespace
}  // namespace talus::serve
