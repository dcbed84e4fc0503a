#pragma once
/// \file
/// Restores the order of one beacon's events. The topics have no order among each other; the bridge's
/// event numbers define it. An event that is next in line passes immediately. An early one waits for a
/// limited time for its predecessors, which then count as lost.

#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

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
    if (sequence == unnumbered) {
      release(event);
      return {ready_.data(), ready_count_};
    }
    if (!started_) begin(sequence);
    if (sequence < next_) {
      if (!is_restart(event, now)) {
        ++counters_.duplicated;
        return {};
      }
      restart_numbering(event, now);
      release_due(now);
    } else if (sequence == next_ && waiting_ == 0) {
      ++next_;
      release(event);
    } else {
      store(event, now);
      release_due(now);
    }
    late_count_ = 0;
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

  void release(const Event& event) { ready_[ready_count_++] = {event, std::exchange(is_restarting_, false)}; }

  /// Detects a restarted bridge, which counts from the beginning: several late events with successive
  /// numbers, in any order, without one in line between them. A number that was given up is merely late. If
  /// two bridges publish the same address, the first one stays in effect.
  [[nodiscard]] bool is_restart(const Event& event, SteadyTime now) {
    constexpr std::uint64_t min_successive = 4;
    const std::uint64_t sequence = sequence_of(event);
    if (was_given_up(sequence, now)) return false;
    late_[late_count_++ % late_.size()] = event;
    const auto has_come = [&](std::uint64_t number) {
      return std::ranges::any_of(late_events(),
                                 [&](const Event& late) { return sequence_of(late) == number; });
    };
    std::uint64_t first = sequence;
    std::uint64_t end = sequence + 1;
    while (has_come(first - 1)) --first;
    while (has_come(end)) ++end;
    return end - first >= min_successive;
  }

  /// Late events since the last one in line; at most the latest ones.
  [[nodiscard]] std::span<const Event> late_events() const {
    return std::span(late_).first(std::min(late_count_, late_.size()));
  }

  /// Follows the new numbering, beginning with the late events that showed it. `event`: the last of them.
  void restart_numbering(const Event& event, SteadyTime now) {
    const std::uint64_t sequence = sequence_of(event);
    while (waiting_ > 0) skip_to_earliest(now);
    // An old duplicate may have such a number too, but at another time.
    constexpr TimeNs disorder_ns = 100'000'000;
    const TimeNs time_ns = available_at_ns(event);
    const auto is_of_it = [&](const Event& late) {
      const std::uint64_t number = sequence_of(late);
      const TimeNs before_ns = saturated_difference(number < sequence ? available_at_ns(late) : time_ns,
                                                    number < sequence ? time_ns : available_at_ns(late));
      return std::max(number, sequence) - std::min(number, sequence) < capacity / 2 &&
             before_ns <= disorder_ns;
    };
    next_ = sequence;
    for (const Event& late : late_events()) {
      if (is_of_it(late)) next_ = std::min(next_, sequence_of(late));
    }
    // A bridge counts from 1, so the events before were lost, unless it plays a part of a recording.
    if (next_ > 0 && next_ < capacity) counters_.lost += next_ - 1;
    given_up_ = {};
    ++counters_.restarts;
    ++counters_.duplicated;  // the last one is not counted yet
    is_restarting_ = true;
    for (const Event& late : late_events()) {
      if (!is_of_it(late)) continue;
      --counters_.duplicated;
      store(late, now);
    }
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
  std::array<Event, 16> late_{};  ///< ring of the latest late events
  std::size_t late_count_ = 0;    ///< late events since the last one in line
  bool is_restarting_ = false;    ///< true until the first event of a new numbering is released
  std::array<CollatedEvent, capacity + 16 + 1> ready_{};  ///< all waiting and late events, and the new one
  std::size_t ready_count_ = 0;
  std::size_t waiting_ = 0;
  std::uint64_t next_ = 0;
  bool started_ = false;
  std::array<Gap, 16> given_up_{};  ///< latest gaps
  std::size_t given_up_count_ = 0;
  CollatorCounters counters_;
};

}  // namespace sonopose::collation
