#pragma once
/// \file
/// The values of the last two minutes: a run of an hour with many beacons must not fill the memory.

#include <sonopose/samples/time.hpp>

#include <deque>

namespace sonopose::doctor::probe {

template <class T>
class Latest {
public:
  static constexpr TimeNs kept_ns = 120'000'000'000;

  struct Entry {
    TimeNs received_ns = 0;
    T value;
  };

  void add(TimeNs received_ns, const T& value) {
    entries_.push_back({received_ns, value});
    while (entries_.front().received_ns < received_ns - kept_ns) {
      entries_.pop_front();
      has_dropped_ = true;
    }
  }
  void clear() {
    entries_.clear();
    has_dropped_ = false;
  }

  /// The values in order of arrival.
  [[nodiscard]] const std::deque<Entry>& entries() const { return entries_; }
  /// True if older values were dropped.
  [[nodiscard]] bool has_dropped() const { return has_dropped_; }

private:
  std::deque<Entry> entries_;
  bool has_dropped_ = false;
};

}  // namespace sonopose::doctor::probe
