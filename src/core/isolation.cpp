#include "core/isolation.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace talus {
namespace {

// Of linux/landlock.h, which older systems lack (Linux 5.13; the numbers are the same on all architectures).
constexpr long create_ruleset = 444, add_rule = 445, restrict_self = 446;
constexpr std::uint32_t ask_version = 1;
constexpr int path_beneath = 1;
constexpr std::uint64_t read_file = 1U << 2U, read_folder = 1U << 3U;

struct Ruleset {
    std::uint64_t files = 0, network = 0, scopes = 0;
};
#pragma pack(push, 1)
struct PathRule {
    std::uint64_t allowed = 0;
    std::int32_t folder = -1;
};
#pragma pack(pop)

/// Of Landlock; 0: there is none.
int landlock_version() {
    const long version = syscall(create_ruleset, nullptr, 0, ask_version);
    return version > 0 ? static_cast<int>(version) : 0;
}

/// All rights that this version knows: what is not allowed by a rule is refused.
Ruleset everything_of(int version) {
    constexpr std::array files = {13, 14, 15, 15, 16};  // number of rights over files, by version
    Ruleset all;
    all.files = (std::uint64_t{1} << files[static_cast<std::size_t>(std::min(version, 5) - 1)]) - 1;
    if (version >= 4) all.network = 3;  // TCP: bind, connect
    if (version >= 6) all.scopes = 3;   // abstract sockets, signals
    return all;
}

bool restrict_files(const std::vector<std::filesystem::path>& readable) {
    const int version = landlock_version();
    if (version == 0) return false;
    const Ruleset all = everything_of(version);
    const std::size_t size = version >= 6 ? 24 : version >= 4 ? 16 : 8;
    const auto rules = static_cast<int>(syscall(create_ruleset, &all, size, 0));
    if (rules < 0) return false;
    for (const std::filesystem::path& path : readable) {
        PathRule rule;
        rule.folder = open(path.c_str(), O_PATH | O_CLOEXEC);
        if (rule.folder < 0) continue;
        struct stat what {};
        const bool folder = fstat(rule.folder, &what) == 0 && S_ISDIR(what.st_mode);
        rule.allowed = folder ? read_file | read_folder : read_file;
        (void)syscall(add_rule, rules, path_beneath, &rule, 0);
        close(rule.folder);
    }
    const bool done = syscall(restrict_self, rules, 0) == 0;
    close(rules);
    return done;
}

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t architecture = 0;  // no filter
#endif

/// What reading a file with GDAL, SQLite and HDF5 needs: no socket, no other process, no change of the file system.
constexpr std::array allowed_calls = {
    SYS_read,
    SYS_pread64,
    SYS_readv,
    SYS_preadv,
    SYS_write,
    SYS_pwrite64,
    SYS_writev,
    SYS_lseek,
    SYS_close,
    SYS_fstat,
    SYS_newfstatat,
    SYS_statx,
    SYS_statfs,
    SYS_fstatfs,
    SYS_openat,
    SYS_faccessat,
    SYS_faccessat2,
    SYS_readlinkat,
    SYS_getdents64,
    SYS_getcwd,
    SYS_fcntl,
    SYS_flock,
    SYS_fadvise64,
    SYS_fsync,
    SYS_fdatasync,
    SYS_ftruncate,
    SYS_dup,
    SYS_dup3,
    SYS_pipe2,
    SYS_ppoll,
    SYS_mmap,
    SYS_munmap,
    SYS_mremap,
    SYS_mprotect,
    SYS_madvise,
    SYS_brk,
    SYS_mincore,
    SYS_membarrier,
    SYS_futex,
    SYS_set_robust_list,
    SYS_get_robust_list,
    SYS_rseq,
    SYS_set_tid_address,
    SYS_rt_sigaction,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_sigaltstack,
    SYS_getrandom,
    SYS_clock_gettime,
    SYS_clock_getres,
    SYS_clock_nanosleep,
    SYS_nanosleep,
    SYS_gettimeofday,
    SYS_times,
    SYS_getrusage,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_sched_getparam,
    SYS_sched_getscheduler,
    SYS_getpid,
    SYS_gettid,
    SYS_getppid,
    SYS_getuid,
    SYS_geteuid,
    SYS_getgid,
    SYS_getegid,
    SYS_uname,
    SYS_sysinfo,
    SYS_umask,
    SYS_getrlimit,
    SYS_restart_syscall,
    SYS_exit,
    SYS_exit_group,
#ifdef SYS_open
    SYS_open,
    SYS_stat,
    SYS_lstat,
    SYS_access,
    SYS_readlink,
    SYS_poll,
    SYS_pipe,
    SYS_dup2,
    SYS_time,
    SYS_arch_prctl,
    SYS_getdents,
#endif
};

bool restrict_calls() {
    if (architecture == 0) return false;
    std::vector<sock_filter> filter;
    const auto load = [&](std::size_t offset) {
        filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
    };
    const auto answer = [&](std::uint32_t what) { filter.push_back(BPF_STMT(BPF_RET | BPF_K, what)); };
    /// The next statement if the loaded word equals `value`; else the one after it.
    const auto if_equal = [&](std::uint32_t value) {
        filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1));
    };
    load(offsetof(seccomp_data, arch));
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, architecture, 1, 0));
    answer(SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
    for (const long call : allowed_calls) {
        if_equal(static_cast<std::uint32_t>(call));
        answer(SECCOMP_RET_ALLOW);
    }
    // The C library falls back to clone, whose flags can be looked at.
    if_equal(SYS_clone3);
    answer(SECCOMP_RET_ERRNO | ENOSYS);
    const auto with_argument = [&](long call, int argument, std::uint32_t mask, std::uint32_t wanted) {
        filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 5));
        load(offsetof(seccomp_data, args) + 8 * static_cast<std::size_t>(argument));  // its lower half: little endian
        filter.push_back(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, mask));
        if_equal(wanted);
        answer(SECCOMP_RET_ALLOW);
        answer(SECCOMP_RET_ERRNO | EPERM);
    };
    with_argument(SYS_clone, 0, CLONE_THREAD, CLONE_THREAD);                  // threads, no processes
    with_argument(SYS_tgkill, 0, ~0U, static_cast<std::uint32_t>(getpid()));  // abort()
    answer(SECCOMP_RET_ERRNO | EPERM);
    const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
    return syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) == 0;
}

}  // namespace

Isolation available_isolation() {
    const std::uint32_t action = SECCOMP_RET_KILL_PROCESS;
    return {landlock_version() > 0,
            architecture != 0 && syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0};
}

std::string missing_isolation(const Isolation& isolation) {
    if (isolation.complete()) return {};
    const std::string lacks = isolation.files ? "seccomp" : isolation.network ? "Landlock" : "Landlock and seccomp";
    return "this kernel lacks " + lacks +
           ": untrusted files are read in a separate process, but fewer formats are accepted (docs/security.md)";
}

Isolation isolate(const std::vector<std::filesystem::path>& readable) {
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return {};
    const bool files = restrict_files(readable);
    return {files, restrict_calls()};
}

}  // namespace talus
