#include "core/child_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <string_view>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace talus {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_line = 1'000'000, longest_words = 4096;
constexpr int look_every = 50;                                    // ms
constexpr std::chrono::seconds first_grace{10}, second_grace{5};  // after the first and the second request to end
constexpr int cannot_start = 127;

/// A pipe both of whose ends are closed with this object.
struct Pipe {
    int read = -1, write = -1;
    Pipe() {
        int ends[2] = {-1, -1};
        if (pipe2(ends, O_CLOEXEC) != 0) return;
        read = ends[0];
        write = ends[1];
    }
    ~Pipe() {
        close_end(read);
        close_end(write);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    static void close_end(int& end) {
        if (end >= 0) close(end);
        end = -1;
    }
    [[nodiscard]] bool good() const { return read >= 0; }
};

/// Of processor time: the first limit tells the process, the last one ends it.
void limit(int resource, std::uint64_t most) {
    const rlimit wanted{most, resource == RLIMIT_CPU ? most + 2 : most};
    if (most > 0) setrlimit(static_cast<__rlimit_resource>(resource), &wanted);
}

/// Between fork and exec: only what is safe there.
[[noreturn]] void become(const ChildProcess& child, char* const* arguments, const char* folder, int in, int out,
                         int error, pid_t parent) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(cannot_start);  // it ended before that
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(error, STDERR_FILENO);
    if (syscall(SYS_close_range, 3U, ~0U, 0U) != 0) {
        for (int file = 3; file < 65536; ++file) close(file);
    }
    if (child.niceness != 0) setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + child.niceness);
    limit(RLIMIT_AS, child.memory);
    limit(RLIMIT_CPU, static_cast<std::uint64_t>(child.processor_time.count()));
    limit(RLIMIT_FSIZE, child.largest_file);
    if (*folder == 0 || chdir(folder) == 0) execv(arguments[0], arguments);
    constexpr char words[] = "cannot be started";
    (void)!write(STDERR_FILENO, words, sizeof words - 1);
    _exit(cannot_start);
}

/// Reads what there is. False: the other end is closed.
bool read_some(int file, std::string& to) {
    std::array<char, 65536> buffer{};
    const ssize_t count = read(file, buffer.data(), buffer.size());
    if (count > 0) to.append(buffer.data(), static_cast<std::size_t>(count));
    return count > 0 || (count < 0 && (errno == EINTR || errno == EAGAIN));
}

/// Hands the whole lines on; one that is too long is dropped.
void take_lines(std::string& text, const std::function<void(const std::string&)>& on_line) {
    std::size_t from = 0;
    for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', from)) {
        if (on_line) on_line(text.substr(from, end - from));
        from = end + 1;
    }
    text.erase(0, from);
    if (text.size() > longest_line) text.clear();
}

/// Asks a process to end, more and more urgently.
class Ending {
  public:
    Ending(pid_t process, bool at_once) : process_(process), asked_(at_once ? 2 : 0) {}
    void ask() {
        const auto now = Clock::now();
        if (now < next_) return;
        kill(process_, asked_ < 2 ? SIGTERM : SIGKILL);
        next_ = now + (asked_ == 0 ? first_grace : second_grace);
        ++asked_;
    }

  private:
    pid_t process_;
    int asked_;
    Clock::time_point next_{};
};

}  // namespace

Result<ChildOutcome> run_child(const ChildProcess& child) {
    Pipe out, error;
    const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    std::vector<std::string> words{child.program.string()};
    words.insert(words.end(), child.arguments.begin(), child.arguments.end());
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::string folder = child.folder.string();
    if (!child.output.empty()) {
        Pipe::close_end(out.write);
        out.write = open(child.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
        if (out.write < 0) {
            const int why = errno;
            if (nothing >= 0) close(nothing);
            return Error{child.output.string() + ": cannot be written: " + std::strerror(why)};
        }
    }
    const pid_t parent = getpid();
    const pid_t process = out.good() && error.good() && nothing >= 0 ? fork() : -1;
    if (process == 0) become(child, arguments.data(), folder.c_str(), nothing, out.write, error.write, parent);
    const int why = errno;
    if (nothing >= 0) close(nothing);
    if (process < 0) return Error{child.program.string() + ": cannot be started: " + std::strerror(why)};
    Pipe::close_end(out.write);
    Pipe::close_end(error.write);

    ChildOutcome outcome;
    Ending ending(process, child.end_at_once);
    std::string lines;
    const auto begun = Clock::now();
    std::array<pollfd, 2> files = {pollfd{out.read, POLLIN, 0}, pollfd{error.read, POLLIN, 0}};
    int status = 0;
    for (bool ended = false; !ended;) {
        ended = waitpid(process, &status, WNOHANG) == process;  // before the last look at what it wrote
        if (poll(files.data(), files.size(), ended ? 0 : look_every) > 0) {
            if (files[0].revents != 0 && !read_some(out.read, lines)) files[0].fd = -1;
            if (files[1].revents != 0 && !read_some(error.read, outcome.stderr_tail)) files[1].fd = -1;
        }
        take_lines(lines, child.on_line);
        if (outcome.stderr_tail.size() > 2 * longest_words) {
            outcome.stderr_tail.erase(0, outcome.stderr_tail.size() - longest_words);
        }
        if (child.shall_end && child.shall_end()) ending.ask();
        if (child.patience.count() > 0 && Clock::now() - begun > child.patience && !ended) {
            outcome.too_slow = true;
            kill(process, SIGKILL);
        }
    }
    // What was in the pipes still.
    while (files[0].fd >= 0 && poll(files.data(), 1, 0) > 0 && read_some(out.read, lines))
        take_lines(lines, child.on_line);
    while (files[1].fd >= 0 && poll(files.data() + 1, 1, 0) > 0 && read_some(error.read, outcome.stderr_tail)) {
    }
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    if (outcome.exit_code == cannot_start) return Error{child.program.string() + ": cannot be started"};
    return Result<ChildOutcome>(std::move(outcome));
}

bool process_lives(long number) {
    return number > 0 && (kill(static_cast<pid_t>(number), 0) == 0 || errno == EPERM);
}

}  // namespace talus
