// Functions of the C library that open files and make connections, with a note of each that succeeds. See witness.hpp.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif

#include <arpa/inet.h>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

/// With calls of the kernel's alone, which none of the functions below sees.
void note(const char* what, const char* which) {
    const char* log = getenv("WITNESS_LOG");
    if (log == nullptr || which == nullptr || strcmp(which, log) == 0) return;
    const int before = errno;
    // A process that may not open the log any more has it open since it began.
    static int kept = -1;
    static char of[4096] = "";
    int file = kept;
    if (file < 0 || strcmp(of, log) != 0) {
        file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
        if (file >= 0) {
            if (kept >= 0) close(kept);
            // Out of the way of the numbers that tests count.
            const int high = fcntl(file, F_DUPFD_CLOEXEC, 200);
            if (high >= 0) {
                close(file);
                file = high;
            }
            kept = file;
            snprintf(of, sizeof of, "%s", log);
        }
    }
    char line[9000];
    char whole[4096] = "";
    if (strcmp(what, "open") == 0 && which[0] != '/' && getcwd(whole, sizeof whole) != nullptr) strcat(whole, "/");
    const int length = snprintf(line, sizeof line, "%s %s%s\n", what, whole, which);
    if (file >= 0 && length > 0) (void)!syscall(SYS_write, file, line, static_cast<size_t>(length));
    errno = before;
}

template <class F>
F next(const char* name) {
    return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

/// The mode that follows flags which make a file.
mode_t mode_of(int flags, va_list more) {
    return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
}

}  // namespace

// The log is opened before main: afterwards the process may have shut itself in.
__attribute__((constructor)) static void begin() {
    note("process", "begins");
}

#define VISIBLE extern "C" __attribute__((visibility("default")))

#define OPENS(name)                                                           \
    VISIBLE int name(const char* file, int flags, ...) {                      \
        va_list more;                                                         \
        va_start(more, flags);                                                \
        const mode_t mode = mode_of(flags, more);                             \
        va_end(more);                                                         \
        static const auto real = next<int (*)(const char*, int, ...)>(#name); \
        const int made = real(file, flags, mode);                             \
        if (made >= 0 && (flags & O_PATH) == 0) note("open", file);           \
        return made;                                                          \
    }
OPENS(open)
OPENS(open64)

/// A name below an open folder.
static void note_below(int folder, const char* file) {
    if (folder == AT_FDCWD || file == nullptr || file[0] == '/') return note("open", file);
    char link[64], whole[9000];
    snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
    const long length = syscall(SYS_readlinkat, AT_FDCWD, link, whole, 4000);
    snprintf(whole + (length > 0 ? length : 0), 4096, "/%s", file);
    note("open", whole);
}

#define OPENS_AT(name)                                                             \
    VISIBLE int name(int folder, const char* file, int flags, ...) {               \
        va_list more;                                                              \
        va_start(more, flags);                                                     \
        const mode_t mode = mode_of(flags, more);                                  \
        va_end(more);                                                              \
        static const auto real = next<int (*)(int, const char*, int, ...)>(#name); \
        const int made = real(folder, file, flags, mode);                          \
        if (made >= 0 && (flags & O_PATH) == 0) note_below(folder, file);          \
        return made;                                                               \
    }
OPENS_AT(openat)
OPENS_AT(openat64)

#define OPENS_STREAM(name)                                                         \
    VISIBLE FILE* name(const char* file, const char* mode) {                       \
        static const auto real = next<FILE* (*)(const char*, const char*)>(#name); \
        FILE* made = real(file, mode);                                             \
        if (made != nullptr) note("open", file);                                   \
        return made;                                                               \
    }
OPENS_STREAM(fopen)
OPENS_STREAM(fopen64)

VISIBLE int socket(int family, int type, int protocol) {
    static const auto real = next<int (*)(int, int, int)>("socket");
    const int made = real(family, type, protocol);
    if (made >= 0 && (family == AF_INET || family == AF_INET6)) note("socket", "of the internet");
    return made;
}

VISIBLE int connect(int file, const sockaddr* address, socklen_t size) {
    static const auto real = next<int (*)(int, const sockaddr*, socklen_t)>("connect");
    char text[INET6_ADDRSTRLEN] = "";
    if (address->sa_family == AF_INET) {
        note("connect",
             inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text, sizeof text));
    } else if (address->sa_family == AF_INET6) {
        note("connect",
             inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text, sizeof text));
    }
    return real(file, address, size);
}

VISIBLE int getaddrinfo(const char* host, const char* service, const addrinfo* hints, addrinfo** result) {
    static const auto real = next<int (*)(const char*, const char*, const addrinfo*, addrinfo**)>("getaddrinfo");
    note("look up", host);
    return real(host, service, hints, result);
}
