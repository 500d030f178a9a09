#include "fem/base/blas_memory.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <string>
#include <vector>

#include "fem/base/threads.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

/// OpenBLAS: BUFFER_SIZE in common_x86_64.h; smaller on other processors.
constexpr std::size_t kBuffer_bytes = std::size_t(128) << 20;

}  // namespace

void reserve_blas_memory() {
  // Another BLAS may stand in for OpenBLAS: it has no such functions, and no such loop.
  using SetThreadCount = void (*)(int);
  using TakeBuffer = void* (*)(int);
  using GiveBuffer = void (*)(void*);
  const auto find = [](const char* name) { return dlsym(RTLD_DEFAULT, name); };
  const auto set_thread_count = reinterpret_cast<SetThreadCount>(find("openblas_set_num_threads"));
  const auto take_buffer = reinterpret_cast<TakeBuffer>(find("blas_memory_alloc"));
  const auto give_buffer = reinterpret_cast<GiveBuffer>(find("blas_memory_free"));
  // Two that call it at a time would wait for each other's helpers.
  if (set_thread_count) set_thread_count(1);
  if (!take_buffer || !give_buffer) return;
  const std::size_t bytes = kBuffer_bytes * static_cast<std::size_t>(fem::thread_count());
  void* const room = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                          MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED)
    throw InputError("finite elements", "memory",
                     "less than " + std::to_string(bytes >> 20) + " MB of address space are left",
                     "room for the linear algebra's buffers (is it limited by ulimit -v?)");
  munmap(room, bytes);
  // One for each thread that calls it. What is given back is kept for the next one.
  std::vector<void*> buffers;
  for (int thread = 0; thread < fem::thread_count(); ++thread) buffers.push_back(take_buffer(0));
  for (void* const buffer : buffers) give_buffer(buffer);
}

}  // namespace softfinger::fem
