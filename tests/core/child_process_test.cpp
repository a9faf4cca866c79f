#include "core/child_process.hpp"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>

namespace talus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

ChildProcess shell(const std::string& script) {
    ChildProcess child;
    child.program = "/bin/sh";
    child.arguments = {"-c", script};
    return child;
}

/// Not even one that has ended and waits to be noticed.
bool runs(long process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    std::string number, name, state;
    return file >> number >> name >> state && state != "Z";
}

TEST(ChildProcess, its_lines_the_end_of_its_stderr_and_its_exit_code_are_told) {
    std::vector<std::string> lines;
    ChildProcess child = shell("pwd; echo second; echo 'what is wrong' >&2; exit 3");
    child.folder = "/";
    child.on_line = [&](const std::string& line) { lines.push_back(line); };
    const auto outcome = run_child(child);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->exit_code, 3);
    EXPECT_EQ(outcome->stderr_tail, "what is wrong\n");
    EXPECT_THAT(lines, ElementsAre("/", "second"));
}

TEST(ChildProcess, everything_of_a_long_output_arrives_also_after_its_end) {
    std::size_t count = 0;
    ChildProcess child = shell("i=0; while [ $i -lt 20000 ]; do echo line $i; i=$((i+1)); done");
    child.on_line = [&](const std::string&) { ++count; };
    ASSERT_TRUE(run_child(child));
    EXPECT_EQ(count, 20000U);
}

TEST(ChildProcess, it_has_none_of_the_files_that_are_open_here) {
    const int first = open("/dev/null", O_RDONLY), file = fcntl(first, F_DUPFD, 77);  // would be inherited
    ASSERT_GE(file, 77);
    std::vector<std::string> lines;
    ChildProcess child = shell("ls /proc/$$/fd | grep -c " + std::to_string(file));
    child.on_line = [&](const std::string& line) { lines.push_back(line); };
    ASSERT_TRUE(run_child(child));
    close(first);
    close(file);
    EXPECT_THAT(lines, ElementsAre("0"));
}

TEST(ChildProcess, one_that_is_asked_to_end_ends) {
    bool stop = false;
    ChildProcess child = shell("echo begun; while true; do sleep 0.05; done");
    child.shall_end = [&] { return stop; };
    child.on_line = [&](const std::string&) { stop = true; };
    const auto outcome = run_child(child);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->signal, SIGTERM);
    EXPECT_FALSE(outcome->too_slow);
}

TEST(ChildProcess, one_that_takes_too_long_is_ended) {
    ChildProcess child = shell("trap '' TERM; while true; do sleep 0.05; done");
    child.patience = std::chrono::seconds(1);
    const auto outcome = run_child(child);
    ASSERT_TRUE(outcome);
    EXPECT_TRUE(outcome->too_slow);
    EXPECT_EQ(outcome->signal, SIGKILL);
}

TEST(ChildProcess, a_program_that_is_not_there_is_an_error) {
    ChildProcess child;
    child.program = "/no/such/program";
    const auto outcome = run_child(child);
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("/no/such/program"));
}

TEST(ChildProcess, it_ends_with_the_program_that_waits_for_it) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t between = fork();
    if (between == 0) {  // a program that dies while it waits
        ChildProcess child = shell("echo $$; while true; do sleep 0.05; done");
        child.on_line = [&](const std::string& line) {
            (void)!write(ends[1], line.c_str(), line.size() + 1);
            kill(getpid(), SIGKILL);
        };
        (void)run_child(child).ok();
        _exit(1);
    }
    char text[32] = {};
    ASSERT_GT(read(ends[0], text, sizeof text - 1), 0);
    const long grandchild = std::atol(text);
    ASSERT_GT(grandchild, 0);
    waitpid(between, nullptr, 0);
    for (int i = 0; i < 200 && runs(grandchild); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(25));
    EXPECT_FALSE(runs(grandchild));
    close(ends[0]);
    close(ends[1]);
}

}  // namespace
}  // namespace talus
