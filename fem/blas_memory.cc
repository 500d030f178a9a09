#include "fem/blas_memory.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <Eigen/Core>
#include <string>

#include "fem/threads.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

/// OpenBLAS: BUFFER_SIZE in common_x86_64.h; smaller on other processors.
constexpr std::size_t kBuffer_bytes = std::size_t(128) << 20;

}  // namespace

void reserve_blas_memory() {
  // Another BLAS may stand in for OpenBLAS: it has no such function, and no such loop.
  using SetThreadCount = void (*)(int);
  const auto set_blas_thread_count =
      reinterpret_cast<SetThreadCount>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  if (!set_blas_thread_count) return;
  // Two that call it at a time would wait for each other's helpers.
  set_blas_thread_count(1);
  const std::size_t bytes = kBuffer_bytes * static_cast<std::size_t>(fem::thread_count());
  void* const room = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                          MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED)
    throw InputError("finite elements", "memory",
                     "less than " + std::to_string(bytes >> 20) + " MB of address space are left",
                     "room for the linear algebra's buffers (is it limited by ulimit -v?)");
  munmap(room, bytes);
  const Eigen::MatrixXd factor = Eigen::MatrixXd::Ones(512, 512);
  Eigen::MatrixXd product(512, 512);
  product.noalias() = factor * factor;  // by BLAS: EIGEN_USE_BLAS
  if (product(0, 0) != 512)
    throw InputError("finite elements", "linear algebra", "wrong", "a BLAS");
}

}  // namespace softfinger::fem
