#pragma once
/// \file
/// The order of events where nothing is ever lost (keep-all on both sides, a log played as fast as it can
/// be): an event waits for those before it however long it takes.

#include <sonopose/samples/samples.hpp>
#include <sonopose/collation/collator.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace sonopose::collation {

/// Numbering begins with 1, as a log's does. It allocates: for use off the live path.
class LosslessCollator {
public:
  /// More events than any transport holds back: then the first number is not coming any more.
  static constexpr std::size_t capacity = 1U << 16U;

  /// Calls `deliver(event)` for every event that is in line now.
  template <class Deliver>
  void push(const Event& event, const Deliver& deliver) {
    const std::uint64_t sequence = sequence_of(event);
    if (sequence < next_) {
      // Of this run it is a duplicate. But a log that is played again may begin with any of its numbers: they
      // are kept until its first one tells.
      ++counters_.duplicated;
      late_.insert_or_assign(sequence, event);
      if (!late_.contains(1)) return;
      begin_again();
    } else if (!waiting_.emplace(sequence, event).second) {
      ++counters_.duplicated;
    }
    if (waiting_.size() > capacity) {
      counters_.lost += waiting_.begin()->first - next_;
      next_ = waiting_.begin()->first;
    }
    while (!waiting_.empty() && waiting_.begin()->first == next_) {
      const auto node = waiting_.extract(waiting_.begin());
      ++next_;
      deliver(node.mapped());
    }
  }

  [[nodiscard]] const CollatorCounters& counters() const { return counters_; }

  struct Gap {
    std::uint64_t missing = 0;  ///< number of the event that is waited for
    std::size_t held = 0;       ///< events that wait for it
  };
  /// What is waited for; empty where nothing waits.
  [[nodiscard]] std::optional<Gap> gap() const {
    if (waiting_.empty()) return std::nullopt;
    return Gap{next_, waiting_.size()};
  }

private:
  void begin_again() {
    waiting_ = std::move(late_);
    late_.clear();
    counters_.duplicated -= waiting_.size();
    next_ = 1;
    ++counters_.restarts;
  }

  std::uint64_t next_ = 1;
  std::map<std::uint64_t, Event> waiting_;
  std::map<std::uint64_t, Event> late_;  ///< numbers that were delivered already
  CollatorCounters counters_;
};

}  // namespace sonopose::collation
