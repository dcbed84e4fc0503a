#pragma once
/// \file
/// Waiting for another thread or process.

#include <chrono>
#include <thread>

namespace sonopose::test {

/// Polls `done`. Returns false after three minutes without success.
template <class Done>
bool wait_until(const Done& done) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(3);
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace sonopose::test
