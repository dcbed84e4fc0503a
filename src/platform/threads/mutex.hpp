#pragma once
/// \file
/// A mutex, and annotations that say which data it guards. clang checks them (scripts/check tidy); g++
/// ignores them. See https://clang.llvm.org/docs/ThreadSafetyAnalysis.html.

#include <mutex>

// NOLINTBEGIN(cppcoreguidelines-macro-usage): attributes cannot be spelled otherwise
#ifdef __clang__
#define SONOPOSE_THREAD_ANNOTATION(x) __attribute__((x))
#else
#define SONOPOSE_THREAD_ANNOTATION(x)
#endif

/// A member that is used only while this mutex is held.
#define SONOPOSE_GUARDED_BY(mutex) SONOPOSE_THREAD_ANNOTATION(guarded_by(mutex))
/// A function whose caller holds this mutex.
#define SONOPOSE_REQUIRES(mutex) SONOPOSE_THREAD_ANNOTATION(requires_capability(mutex))
// NOLINTEND(cppcoreguidelines-macro-usage)

namespace sonopose::threads {

/// A std::mutex that clang's analysis knows.
class SONOPOSE_THREAD_ANNOTATION(capability("mutex")) Mutex {
public:
  void lock() SONOPOSE_THREAD_ANNOTATION(acquire_capability()) { mutex_.lock(); }
  void unlock() SONOPOSE_THREAD_ANNOTATION(release_capability()) { mutex_.unlock(); }

  /// States for the analysis, in a lambda that is called under the lock, that the mutex is held.
  void assert_held() const SONOPOSE_THREAD_ANNOTATION(assert_capability()) {}

private:
  std::mutex mutex_;
};

/// Holds a mutex until its scope ends.
class SONOPOSE_THREAD_ANNOTATION(scoped_lockable) Lock {
public:
  explicit Lock(Mutex& mutex) SONOPOSE_THREAD_ANNOTATION(acquire_capability(mutex)) : mutex_(mutex) {
    mutex_.lock();
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() SONOPOSE_THREAD_ANNOTATION(release_capability()) { mutex_.unlock(); }

  // For std::condition_variable_any alone, which holds the mutex again when it returns.
  void lock() SONOPOSE_THREAD_ANNOTATION(acquire_capability()) { mutex_.lock(); }
  void unlock() SONOPOSE_THREAD_ANNOTATION(release_capability()) { mutex_.unlock(); }

private:
  Mutex& mutex_;
};

}  // namespace sonopose::threads
