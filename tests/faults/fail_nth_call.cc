// Preloaded into the program under test (LD_PRELOAD): one call of one kind fails, as on a machine
// whose memory, disk or descriptors are used up.
//   SOFTFINGER_FAULT=KIND:N            the N-th call, counted from the start of main()
//   SOFTFINGER_FAULT_REACHED=FILE      is made when it fails
// KIND: allocation (operator new, of any size), open (for writing), write, fsync, rename.
// Programs that the program starts are left alone.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <new>

namespace {

enum class Kind { none, allocation, open, write, fsync, rename };

// Constant initialisation only: calls come before and after any constructor of this library.
Kind g_kind = Kind::none;
std::atomic<long> g_calls_left{0};
char g_reached[4096] = "";

bool fails(Kind kind) {
  if (kind != g_kind || g_calls_left.fetch_sub(1) != 1) return false;
  // Not through open(), which may be what fails.
  const long file = syscall(SYS_openat, AT_FDCWD, g_reached, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file >= 0) syscall(SYS_close, file);
  return true;
}

int fail(int error) {
  errno = error;
  return -1;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

void read_environment() {
  const char* const names[] = {"", "allocation", "open", "write", "fsync", "rename"};
  const char *fault = std::getenv("SOFTFINGER_FAULT"),
             *reached = std::getenv("SOFTFINGER_FAULT_REACHED");
  const char* colon = fault ? std::strchr(fault, ':') : nullptr;
  if (colon && reached && std::strlen(reached) < sizeof g_reached) {
    std::strcpy(g_reached, reached);
    g_calls_left = std::atol(colon + 1);
    for (int kind = 1; kind <= int(Kind::rename); ++kind)
      if (std::strncmp(fault, names[kind], std::size_t(colon - fault)) == 0) g_kind = Kind(kind);
  }
  for (const char* name : {"SOFTFINGER_FAULT", "SOFTFINGER_FAULT_REACHED", "LD_PRELOAD"})
    unsetenv(name);
}

using Main = int (*)(int, char**, char**);
Main g_main = nullptr;

int main_with_faults(int argc, char** argv, char** environment) {
  // The program cannot handle failures before main(). Calls are therefore counted from here on.
  read_environment();
  return g_main(argc, argv, environment);
}

bool writes(int flags) { return (flags & O_ACCMODE) != O_RDONLY; }

/// The mode that follows the flags where a file may be made.
mode_t mode_of(int flags, va_list rest) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(rest, unsigned)) : 0;
}

}  // namespace

void* operator new(std::size_t size) {
  void* memory = fails(Kind::allocation) ? nullptr : std::malloc(size > 0 ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

extern "C" {

int __libc_start_main(Main program, int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*linker_fini)(), void* stack_end) {
  g_main = program;
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  return next<Start>("__libc_start_main")(main_with_faults, argc, argv, init, fini, linker_fini,
                                          stack_end);
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  if (writes(flags) && fails(Kind::open)) return fail(EIO);
  return next<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  if (writes(flags) && fails(Kind::open)) return fail(EIO);
  return next<int (*)(const char*, int, ...)>("open64")(path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  if (writes(flags) && fails(Kind::open)) return fail(EIO);
  return next<int (*)(int, const char*, int, ...)>("openat")(folder, path, flags, mode);
}

// The one line that says what went wrong is what the test wants to read.
ssize_t write(int file, const void* data, std::size_t size) {
  if (file != STDERR_FILENO && fails(Kind::write)) return fail(ENOSPC);
  return next<ssize_t (*)(int, const void*, std::size_t)>("write")(file, data, size);
}

// No power is cut, so that no test has to wait for the disk, which a busy machine makes it do for
// minutes.
int fsync(int file) {
  if (fails(Kind::fsync)) return fail(EIO);
  return fcntl(file, F_GETFD) < 0 ? -1 : 0;
}

int rename(const char* from, const char* to) {
  return fails(Kind::rename) ? fail(EIO)
                             : next<int (*)(const char*, const char*)>("rename")(from, to);
}

}  // extern "C"
