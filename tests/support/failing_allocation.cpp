// Preload (LD_PRELOAD) that makes one allocation with `new` fail after SIGUSR1. It is the next one that
// matches the variable SONOPOSE_TEST_FAILING_ALLOCATION: "main" for the main thread, "=BYTES" for that size,
// anything else for the thread of that name.

#include <atomic>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <pthread.h>
#include <string_view>
#include <unistd.h>

namespace {

std::atomic<bool> is_armed = false;

bool is_described(std::string_view description, std::size_t size) {
  if (description.empty()) return false;
  if (description.front() == '=') {
    std::size_t bytes = 0;
    std::from_chars(description.data() + 1, description.data() + description.size(), bytes);
    return size == bytes;
  }
  if (description == "main") return ::gettid() == ::getpid();
  char name[16] = "";  // Linux's maximum length
  return ::pthread_getname_np(::pthread_self(), name, sizeof name) == 0 && description == name;
}

/// Returns true for the allocation that fails.
bool fails(std::size_t size) {
  if (!is_armed) return false;
  const char* const description = std::getenv("SONOPOSE_TEST_FAILING_ALLOCATION");
  return description != nullptr && is_described(description, size) && is_armed.exchange(false);
}

__attribute__((constructor)) void listen() {
  std::signal(SIGUSR1, [](int) { is_armed = true; });
}

}  // namespace

void* operator new(std::size_t size) {
  void* const memory = fails(size) ? nullptr : std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}
