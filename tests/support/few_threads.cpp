// Preload (LD_PRELOAD) that lets no more threads start than the variable SONOPOSE_TEST_MAX_THREADS says, like
// a limit of processes, which does not bind the superuser.

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <iterator>
#include <pthread.h>

namespace {

std::ptrdiff_t thread_count() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
}

}  // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) noexcept {
  const char* const limit = std::getenv("SONOPOSE_TEST_MAX_THREADS");
  if (limit != nullptr && thread_count() >= std::atoi(limit)) return EAGAIN;
  using Call = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as dlsym(3) wants it
  static const auto next = reinterpret_cast<Call>(::dlsym(RTLD_NEXT, "pthread_create"));
  return next(thread, attributes, start, argument);
}
