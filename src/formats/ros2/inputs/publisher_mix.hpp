#pragma once
/// \file
/// Recognises publishers of one topic that send at the same time.

#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonopose::ros2 {

/// One topic. A driver that was started again has another identity, but the former one does not come back.
class PublisherMix {
public:
  static constexpr TimeNs span_ns = 5'000'000'000;
  static constexpr int enough_returns = 3;  ///< within `span_ns`

  /// Takes the identity of a message's publisher; 0: unknown. Returns true while several take turns.
  bool on(std::uint64_t publisher, SteadyTime now) {
    constexpr std::size_t max_known = 16;
    if (publisher == 0 || publisher == latest_) return false;
    latest_ = publisher;
    if (std::ranges::find(known_, publisher) == known_.end()) {
      if (known_.size() == max_known) known_.erase(known_.begin());
      known_.push_back(publisher);
      return false;
    }
    if (returns_ == 0 || now - since_ > span_ns) {
      returns_ = 0;
      since_ = now;
    }
    return ++returns_ >= enough_returns;
  }

private:
  std::vector<std::uint64_t> known_;
  std::uint64_t latest_ = 0;
  int returns_ = 0;
  SteadyTime since_;
};

}  // namespace sonopose::ros2
