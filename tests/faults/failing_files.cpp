// A library for LD_PRELOAD, under which one call that changes a file fails as on a full disk:
//   FAILING_FOLDER  only files below it count; empty: memory does instead, every operator new of 64 KiB or more
//   FAILING_CALL    which of them fails, from 1; 0: none
//   FAILING_LOG     a file that gets a line per call, with the name of the function and the path, or the bytes
// It stands between a program and the C library, so that what GDAL, SQLite and the C++ library write counts as well.
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <new>
#include <string>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <climits>

namespace {

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): of the process, as the files are
std::atomic<long> calls{0};
std::array<std::atomic<bool>, 4096> ours{};  // file descriptors below the folder that may be written
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

const std::string& folder() {
    static const std::string path = [] {
        const char* given = std::getenv("FAILING_FOLDER");
        return std::string(given != nullptr ? given : "");
    }();
    return path;
}

std::string absolute(const char* path) {
    if (path[0] == '/') return path;
    std::array<char, PATH_MAX> here{};
    if (getcwd(here.data(), here.size()) == nullptr) return path;
    return std::string(here.data()) + "/" + path;
}

bool below_folder(const char* path) {
    if (path == nullptr || folder().empty()) return false;
    const std::string full = absolute(path);
    return full.rfind(folder() + "/", 0) == 0;
}

/// Counts a call; whether it is the one that fails, which sets errno.
bool fails(const char* function, const char* path) {
    static const long wanted = [] {
        const char* given = std::getenv("FAILING_CALL");
        return given != nullptr ? std::atol(given) : 0;
    }();
    static const char* log = std::getenv("FAILING_LOG");
    const long number = ++calls;
    if (log != nullptr) {
        static auto* real_open = next<int(const char*, int, ...)>("open");
        static auto* real_write = next<ssize_t(int, const void*, size_t)>("write");
        const int file = real_open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
        const std::string line = std::string(function) + " " + path + (number == wanted ? " fails\n" : "\n");
        (void)!real_write(file, line.data(), line.size());
        (void)close(file);
    }
    if (number != wanted) return false;
    errno = ENOSPC;
    return true;
}

std::string path_of(int file) {
    std::array<char, PATH_MAX> path{};
    const std::string link = "/proc/self/fd/" + std::to_string(file);
    const ssize_t length = readlink(link.c_str(), path.data(), path.size() - 1);
    return {path.data(), length > 0 ? static_cast<std::size_t>(length) : 0};
}

bool is_ours(int file) {
    return file >= 0 && static_cast<std::size_t>(file) < ours.size() && ours[static_cast<std::size_t>(file)];
}

bool fails(const char* function, int file) {
    return is_ours(file) && fails(function, path_of(file).c_str());
}
bool fails(const char* function, FILE* stream) {
    return stream != nullptr && fails(function, fileno(stream));
}

void note(int file, bool written) {
    if (file >= 0 && static_cast<std::size_t>(file) < ours.size()) ours[static_cast<std::size_t>(file)] = written;
}

bool writes(const char* mode) {
    return std::strpbrk(mode, "wa+") != nullptr;
}

int open_as(const char* name, const char* path, int flags, mode_t mode) {
    const bool written = (flags & O_ACCMODE) != O_RDONLY && below_folder(path);
    if (written && (flags & O_CREAT) != 0 && fails("open", path)) return -1;
    const int file = next<int(const char*, int, ...)>(name)(path, flags, mode);
    note(file, written);
    return file;
}

FILE* fopen_as(const char* name, const char* path, const char* mode) {
    const bool written = writes(mode) && below_folder(path);
    if (written && fails("fopen", path)) return nullptr;
    FILE* stream = next<FILE*(const char*, const char*)>(name)(path, mode);
    if (stream != nullptr) note(fileno(stream), written);
    return stream;
}

constexpr size_t large = 65536;  // bytes

void* allocate(size_t bytes) {
    if (bytes >= large && folder().empty() && fails("allocate", std::to_string(bytes).c_str())) return nullptr;
    return std::malloc(bytes == 0 ? 1 : bytes);
}

}  // namespace

void* operator new(size_t bytes) {
    void* place = allocate(bytes);
    if (place == nullptr) throw std::bad_alloc();
    return place;
}
void* operator new(size_t bytes, const std::nothrow_t&) noexcept {
    return allocate(bytes);
}
void operator delete(void* place) noexcept {
    std::free(place);
}
void operator delete(void* place, size_t) noexcept {
    std::free(place);
}

// NOLINTBEGIN(readability-identifier-naming,cert-dcl50-cpp): the C library's
extern "C" {

int open(const char* path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    const mode_t mode = va_arg(more, mode_t);
    va_end(more);
    return open_as("open", path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    const mode_t mode = va_arg(more, mode_t);
    va_end(more);
    return open_as("open64", path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
    return fopen_as("fopen", path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
    return fopen_as("fopen64", path, mode);
}
int close(int file) {
    note(file, false);
    return next<int(int)>("close")(file);
}
ssize_t write(int file, const void* bytes, size_t count) {
    if (fails("write", file)) return -1;
    return next<ssize_t(int, const void*, size_t)>("write")(file, bytes, count);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
    if (fails("writev", file)) return -1;
    return next<ssize_t(int, const struct iovec*, int)>("writev")(file, parts, count);
}
ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
    if (fails("pwrite", file)) return -1;
    return next<ssize_t(int, const void*, size_t, off_t)>("pwrite")(file, bytes, count, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
    if (fails("pwrite", file)) return -1;
    return next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(file, bytes, count, at);
}
int ftruncate(int file, off_t length) {
    if (fails("ftruncate", file)) return -1;
    return next<int(int, off_t)>("ftruncate")(file, length);
}
int ftruncate64(int file, off64_t length) {
    if (fails("ftruncate", file)) return -1;
    return next<int(int, off64_t)>("ftruncate64")(file, length);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* stream) {
    if (fails("fwrite", stream)) return 0;
    return next<size_t(const void*, size_t, size_t, FILE*)>("fwrite")(bytes, size, count, stream);
}
int fflush(FILE* stream) {
    if (fails("fflush", stream)) return EOF;
    return next<int(FILE*)>("fflush")(stream);
}
int fclose(FILE* stream) {
    const bool failing = fails("fclose", stream);
    note(fileno(stream), false);
    const int closed = next<int(FILE*)>("fclose")(stream);
    if (failing) errno = ENOSPC;
    return failing ? EOF : closed;
}
int rename(const char* from, const char* to) {
    if (below_folder(to) && fails("rename", to)) return -1;
    return next<int(const char*, const char*)>("rename")(from, to);
}
int mkdir(const char* path, mode_t mode) {
    if (below_folder(path) && fails("mkdir", path)) return -1;
    return next<int(const char*, mode_t)>("mkdir")(path, mode);
}
int link(const char* from, const char* to) {
    if (below_folder(to) && fails("link", to)) return -1;
    return next<int(const char*, const char*)>("link")(from, to);
}

}  // extern "C"
// NOLINTEND(readability-identifier-naming,cert-dcl50-cpp)
