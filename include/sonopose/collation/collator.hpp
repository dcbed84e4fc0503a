#pragma once
/// \file
/// Restores the order of one beacon's events. The three topics have no order among each other; the bridge's
/// event numbers define it. An event that is next in line passes immediately. An early one waits for a
/// limited time for its predecessors, which then count as lost.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>

namespace sonopose::collation {

struct CollatorCounters {
  std::uint64_t lost = 0;        ///< event numbers that never arrived
  std::uint64_t duplicated = 0;  ///< events that arrived twice, or after they had been given up
  std::uint64_t restarts = 0;    ///< restarts of the numbering, and jumps ahead
};

/// Most events that can be lost in succession: hours of one beacon. A number further ahead is corrupt or from
/// another numbering.
inline constexpr std::uint64_t max_lost = 10'000'000;

/// Counts the numbers of [`from`, `to`), which never arrived.
inline void count_gap(CollatorCounters& counters, std::uint64_t from, std::uint64_t to) {
  if (to - from > max_lost) {
    ++counters.restarts;
  } else {
    counters.lost += to - from;
  }
}

/// An event that is next in line.
struct CollatedEvent {
  Event event;
  bool restart = false;  ///< true for the first event of a new numbering
};

/// Collates live events. It has a fixed size and does not allocate.
class Collator {
public:
  /// Number of events that can wait. If more arrive, the gap before them is given up early.
  static constexpr std::size_t capacity = 64;

  /// `timeout_ns` limits how long an event waits for its predecessors.
  explicit Collator(TimeNs timeout_ns = 5'000'000) : timeout_ns_(timeout_ns) {}

  /// Adds an event that arrived at `now`. Returns the events that are now in line, in order: without a gap,
  /// the event itself. The span is valid until the next call. A gap is given up only when a later event
  /// arrives, so no timer is needed.
  std::span<const CollatedEvent> push(const Event& event, SteadyTime now) {
    ready_count_ = 0;
    const std::uint64_t sequence = sequence_of(event);
    if (!started_) begin(sequence);
    const bool late = sequence < next_;
    if (late && !is_restart(event, now)) {
      ++counters_.duplicated;
      return {};
    }
    if (late) restart_numbering(now);
    late_run_ = 0;
    if (sequence == next_ && waiting_ == 0) {
      ++next_;
      release(event);
    } else {
      store(event, now);
      release_due(now);
    }
    return {ready_.data(), ready_count_};
  }

  [[nodiscard]] const CollatorCounters& counters() const { return counters_; }

private:
  struct Slot {
    bool used = false;
    SteadyTime since;
    Event event;
  };

  void begin(std::uint64_t sequence) {
    started_ = true;
    next_ = sequence;
  }

  void release(const Event& event, bool restart = false) { ready_[ready_count_++] = {event, restart}; }

  /// Detects a restarted bridge, which counts from the beginning: several late numbers in succession without
  /// one in line between them. A number that was given up is merely late. If two bridges publish the same
  /// address, the first one stays in effect.
  [[nodiscard]] bool is_restart(const Event& event, SteadyTime now) {
    const std::uint64_t sequence = sequence_of(event);
    if (was_given_up(sequence, now)) return false;
    late_run_ = sequence == late_next_ ? late_run_ + 1 : 1;
    late_next_ = sequence + 1;
    if (late_run_ > late_.size()) return true;
    late_[late_run_ - 1] = event;
    return false;
  }

  /// Follows the new numbering, beginning with the late events that showed it.
  void restart_numbering(SteadyTime now) {
    while (waiting_ > 0) skip_to_earliest(now);
    next_ = sequence_of(late_.back()) + 1;
    given_up_ = {};
    ++counters_.restarts;
    counters_.duplicated -= late_.size();
    for (const Event& event : late_) release(event, &event == &late_.front());
  }

  /// Numbers that were given up; empty if `to` is 0.
  struct Gap {
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    SteadyTime since;
  };

  Slot& slot_of(std::uint64_t sequence) { return slots_[sequence % capacity]; }

  void store(const Event& event, SteadyTime now) {
    const std::uint64_t sequence = sequence_of(event);
    while (waiting_ > 0 && sequence >= next_ + capacity) skip_to_earliest(now);
    if (waiting_ == 0 && sequence >= next_ + capacity) give_up_to(sequence, now);  // too wide to be filled
    Slot& slot = slot_of(sequence);
    if (slot.used) {
      ++counters_.duplicated;
      return;
    }
    slot = {true, now, event};
    ++waiting_;
  }

  /// Counts all missing events before `sequence` as lost.
  void give_up_to(std::uint64_t sequence, SteadyTime now) {
    if (sequence == next_) return;
    constexpr std::uint64_t max_gap = 1024;  // a wider gap is no longer filled
    count_gap(counters_, next_, sequence);
    if (sequence - next_ <= max_gap) {
      given_up_[given_up_count_++ % given_up_.size()] = {next_, sequence, now};
    }
    next_ = sequence;
  }

  [[nodiscard]] bool was_given_up(std::uint64_t sequence, SteadyTime now) const {
    constexpr TimeNs remembered_ns = 1'000'000'000;
    for (const Gap& gap : given_up_) {
      if (gap.from <= sequence && sequence < gap.to && now - gap.since < remembered_ns) return true;
    }
    return false;
  }

  /// Gives up the gap before the earliest waiting event.
  void skip_to_earliest(SteadyTime now) {
    std::uint64_t earliest = next_;
    while (!slot_of(earliest).used) ++earliest;
    give_up_to(earliest, now);
    release_run();
  }

  void release_run() {
    while (waiting_ > 0 && slot_of(next_).used) {
      Slot& slot = slot_of(next_);
      slot.used = false;
      --waiting_;
      ++next_;
      release(slot.event);
    }
  }

  void release_due(SteadyTime now) {
    release_run();
    while (waiting_ > 0 && now - longest_wait_began() > timeout_ns_) skip_to_earliest(now);
  }

  [[nodiscard]] SteadyTime longest_wait_began() const {
    SteadyTime earliest = SteadyTime::max();
    for (const Slot& slot : slots_) {
      if (slot.used && slot.since < earliest) earliest = slot.since;
    }
    return earliest;
  }

  TimeNs timeout_ns_;
  std::array<Slot, capacity> slots_{};
  std::array<Event, 3> late_{};  ///< latest late events in succession
  /// All waiting events, the late ones, and the new one.
  std::array<CollatedEvent, capacity + std::tuple_size_v<decltype(late_)> + 1> ready_{};
  std::size_t ready_count_ = 0;
  std::size_t waiting_ = 0;
  std::uint64_t next_ = 0;
  bool started_ = false;
  std::size_t late_run_ = 0;  ///< number of late events in succession
  std::uint64_t late_next_ = 0;
  std::array<Gap, 16> given_up_{};  ///< latest gaps
  std::size_t given_up_count_ = 0;
  CollatorCounters counters_;
};

}  // namespace sonopose::collation
