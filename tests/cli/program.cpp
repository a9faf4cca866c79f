#include "cli/program.hpp"

#include <array>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sstream>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace talus::test {
namespace {

[[noreturn]] void become_program(const std::vector<std::string>& arguments, const ProgramOptions& options, int out,
                                 int error) {
    // A test started in the background ignores SIGINT; the program under test must not inherit that.
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) signal(number, SIG_DFL);
    if (options.largest_file > 0) {
        signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{static_cast<rlim_t>(options.largest_file), static_cast<rlim_t>(options.largest_file)};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    std::vector<char*> argv{const_cast<char*>(TALUS_PROGRAM)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    for (std::size_t i = 0; environ[i] != nullptr;) {  // of the tests themselves, which the program does not know
        const std::string entry = environ[i];
        const std::string name = entry.substr(0, entry.find('='));
        if (name.starts_with("TALUS_") && name != "TALUS_DATA" && name != "TALUS_SIMD") {
            unsetenv(name.c_str());
        } else {
            ++i;
        }
    }
    for (const std::string& variable : options.environment) putenv(const_cast<char*>(variable.c_str()));
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(options.out.empty() ? out : open(options.out.c_str(), O_WRONLY), STDOUT_FILENO);
    dup2(error, STDERR_FILENO);
    if (chdir(options.folder.c_str()) == 0) execv(TALUS_PROGRAM, argv.data());
    _exit(127);
}

}  // namespace

ProgramOutcome run_program(const std::vector<std::string>& arguments, const ProgramOptions& options) {
    std::array<int, 2> out{}, error{};
    if (pipe2(out.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    if (options.error_is_terminal) {
        const winsize size{24, 100, 0, 0};
        if (openpty(&error[0], &error[1], nullptr, nullptr, &size) != 0) throw std::runtime_error("no terminal");
    } else if (pipe2(error.data(), O_CLOEXEC) != 0) {
        throw std::runtime_error("no pipe");
    }
    const pid_t process = fork();
    if (process < 0) throw std::runtime_error("cannot fork");
    if (process == 0) become_program(arguments, options, out[1], error[1]);
    close(out[1]);
    close(error[1]);

    ProgramOutcome outcome;
    bool called = !options.while_running;
    std::array<pollfd, 2> streams{pollfd{out[0], POLLIN, 0}, pollfd{error[0], POLLIN, 0}};
    std::array<std::string*, 2> texts{&outcome.out, &outcome.error};
    while (streams[0].fd >= 0 || streams[1].fd >= 0) {
        if (poll(streams.data(), streams.size(), 60000) <= 0) {
            kill(process, SIGKILL);
            break;
        }
        for (std::size_t i = 0; i < streams.size(); ++i) {
            if (streams[i].fd < 0 || streams[i].revents == 0) continue;
            std::array<char, 4096> bytes{};
            const ssize_t count = read(streams[i].fd, bytes.data(), bytes.size());
            if (count <= 0) {  // a terminal whose program has ended gives an error, a pipe zero
                close(streams[i].fd);
                streams[i].fd = -1;
                continue;
            }
            texts[i]->append(bytes.data(), static_cast<std::size_t>(count));
        }
        const auto seen = [&](const std::string& text) { return text.find(options.wait_for) != std::string::npos; };
        if (!called && (seen(outcome.out) || seen(outcome.error))) {
            called = true;
            options.while_running(process);
        }
    }
    int status = 0;
    waitpid(process, &status, 0);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

}  // namespace talus::test
