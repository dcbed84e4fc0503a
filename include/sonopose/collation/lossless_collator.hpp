#pragma once
/// \file
/// Restores the order of events on a lossless path (keep-all on both sides, a log played at full speed). An
/// event waits for its predecessors without a time limit.

#include <sonopose/collation/collator.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace sonopose::collation {

/// Collates events that are numbered from 1, as in a log. It allocates and is not for the live path.
class LosslessCollator {
public:
  /// More events than any transport buffers. If so many wait, the missing event will not arrive.
  static constexpr std::size_t capacity = 1U << 16U;

  /// Adds an event. Returns the events that are now in line, in order. The span is valid until the next call.
  std::span<const CollatedEvent> push(const Event& event) {
    ready_.clear();
    const std::uint64_t sequence = sequence_of(event);
    if (sequence == unnumbered) {
      ready_.push_back({event, false});
      return ready_;
    }
    bool restart = false;
    if (sequence < next_) {
      // Either duplicates, or the first events of a log that is played again, which may arrive in any order.
      // Number 1 decides; until then they are kept.
      ++counters_.duplicated;
      late_.insert_or_assign(sequence, event);
      if (!late_.contains(1)) return {};
      restart_numbering();
      restart = true;
    } else if (!waiting_.emplace(sequence, event).second) {
      ++counters_.duplicated;
    }
    if (waiting_.size() > capacity) {
      count_gap(counters_, next_, waiting_.begin()->first);
      next_ = waiting_.begin()->first;
    }
    while (!waiting_.empty() && waiting_.begin()->first == next_) {
      const auto node = waiting_.extract(waiting_.begin());
      ++next_;
      ready_.push_back({node.mapped(), std::exchange(restart, false)});
    }
    return ready_;
  }

  [[nodiscard]] const CollatorCounters& counters() const { return counters_; }

  struct Gap {
    std::uint64_t missing = 0;  ///< number of the missing event
    std::size_t waiting = 0;    ///< number of events that wait for it
  };
  /// Gap before the waiting events; empty if none wait.
  [[nodiscard]] std::optional<Gap> gap() const {
    if (waiting_.empty()) return std::nullopt;
    return Gap{next_, waiting_.size()};
  }

private:
  void restart_numbering() {
    waiting_ = std::move(late_);
    late_.clear();
    counters_.duplicated -= waiting_.size();
    next_ = 1;
    ++counters_.restarts;
  }

  std::uint64_t next_ = 1;
  std::map<std::uint64_t, Event> waiting_;
  std::map<std::uint64_t, Event> late_;  ///< events with numbers that were released before
  std::vector<CollatedEvent> ready_;
  CollatorCounters counters_;
};

}  // namespace sonopose::collation
