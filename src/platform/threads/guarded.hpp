#pragma once
/// \file
/// A value that several threads use.

#include <mutex>
#include <utility>

namespace sonopose::threads {

/// Gives access to a value only under its mutex.
template <class T>
class Guarded {
public:
  template <class... Arguments>
  explicit Guarded(Arguments&&... arguments) : value_(std::forward<Arguments>(arguments)...) {}

  /// Returns `use(value)`, called under the lock. `use` only computes: it must not read, write or wait.
  template <class Use>
  auto with(const Use& use) {
    const std::lock_guard lock(mutex_);
    return use(value_);
  }

private:
  std::mutex mutex_;
  T value_;
};

}  // namespace sonopose::threads
