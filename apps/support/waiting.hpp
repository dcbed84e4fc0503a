#pragma once
// A progress line for work without a progress report.

#include "progress.hpp"
#include "threads/mutex.hpp"

#include <condition_variable>
#include <string>
#include <thread>

namespace sonopose::apps {

/// Shows the elapsed time, or its share of the expected time, until it is destroyed. Has no effect without a
/// terminal.
class Waiting {
public:
  /// `expected_s`: expected duration; 0 if unknown.
  explicit Waiting(std::string what, double expected_s = 0);
  ~Waiting();
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

private:
  void show();

  std::string what_;
  double expected_s_;
  Progress progress_;
  threads::Mutex mutex_;
  std::condition_variable_any change_;
  bool ended_ SONOPOSE_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace sonopose::apps
