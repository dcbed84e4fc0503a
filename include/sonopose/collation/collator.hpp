#pragma once
/// \file
/// Three topics have no order among each other; the event numbers that the bridge gives restore it. An event
/// that is next in line passes at once; one that came too early waits a declared time for those before it,
/// which are then counted as lost.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace sonopose::collation {

struct CollatorCounters {
  std::uint64_t lost = 0;        ///< event numbers that never came
  std::uint64_t duplicated = 0;  ///< came twice, or after they had been given up
  std::uint64_t restarts = 0;    ///< the numbering began anew
};

/// The order of one beacon's events. Fixed size, allocates nothing.
class Collator {
public:
  /// Events that can wait at once; when all places are taken the gap is given up early.
  static constexpr std::size_t capacity = 64;

  /// How long a gap is waited for.
  explicit Collator(TimeNs timeout_ns = 5'000'000) : timeout_ns_(timeout_ns) {}

  /// Takes an event that arrived at `now` (steady clock) and calls `deliver(event)` for each that is
  /// in line now. Without a gap that is the event itself, at once. Gaps are given up only here, when a later
  /// event arrives: no clock of its own is needed.
  template <class Deliver>
  void push(const Event& event, SteadyTime now, const Deliver& deliver) {
    const std::uint64_t sequence = sequence_of(event);
    if (!started_) begin(sequence);
    if (sequence < next_ && !is_restart(sequence, now)) {
      ++counters_.duplicated;
      return;
    }
    if (sequence < next_) begin_again(sequence, now, deliver);
    late_run_ = 0;
    if (sequence == next_ && waiting_ == 0) {
      ++next_;
      deliver(event);
    } else {
      hold(event, now, deliver);
      release(now, deliver);
    }
  }

  [[nodiscard]] const CollatorCounters& counters() const { return counters_; }

private:
  struct Place {
    bool taken = false;
    SteadyTime since;
    Event event;
  };

  void begin(std::uint64_t sequence) {
    started_ = true;
    next_ = sequence;
  }

  /// A bridge that was started anew counts from the beginning again: late numbers, but one after the other
  /// with none in line between them. (Of two bridges that publish the same address the first goes on being
  /// served.) What was given up and comes after all is late and no restart, however much of it there is.
  [[nodiscard]] bool is_restart(std::uint64_t sequence, SteadyTime now) {
    constexpr int enough = 4;
    if (was_given_up(sequence, now)) return false;
    late_run_ = sequence == late_next_ ? late_run_ + 1 : 1;
    late_next_ = sequence + 1;
    return late_run_ >= enough;
  }

  template <class Deliver>
  void begin_again(std::uint64_t sequence, SteadyTime now, const Deliver& deliver) {
    while (waiting_ > 0) skip_to_earliest(now, deliver);
    next_ = sequence;
    given_up_ = {};
    ++counters_.restarts;
  }

  /// Numbers that were given up; a `to` of 0: none.
  struct Gap {
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    SteadyTime since;
  };

  Place& place_of(std::uint64_t sequence) { return places_[sequence % capacity]; }

  template <class Deliver>
  void hold(const Event& event, SteadyTime now, const Deliver& deliver) {
    const std::uint64_t sequence = sequence_of(event);
    while (waiting_ > 0 && sequence >= next_ + capacity) skip_to_earliest(now, deliver);
    if (waiting_ == 0 && sequence >= next_ + capacity) give_up_to(sequence, now);  // too wide to be filled
    Place& place = place_of(sequence);
    if (place.taken) {
      ++counters_.duplicated;
      return;
    }
    place = {true, now, event};
    ++waiting_;
  }

  /// Everything before `sequence` that has not come is lost.
  void give_up_to(std::uint64_t sequence, SteadyTime now) {
    if (sequence == next_) return;
    constexpr std::uint64_t widest = 1024;  // beyond that a number was wrong, or the numbering is another one
    counters_.lost += sequence - next_;
    if (sequence - next_ <= widest) {
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

  /// Gives up the gap before the earliest event that waits.
  template <class Deliver>
  void skip_to_earliest(SteadyTime now, const Deliver& deliver) {
    std::uint64_t earliest = next_;
    while (!place_of(earliest).taken) ++earliest;
    give_up_to(earliest, now);
    deliver_run(deliver);
  }

  template <class Deliver>
  void deliver_run(const Deliver& deliver) {
    while (waiting_ > 0 && place_of(next_).taken) {
      Place& place = place_of(next_);
      place.taken = false;
      --waiting_;
      ++next_;
      deliver(place.event);
    }
  }

  template <class Deliver>
  void release(SteadyTime now, const Deliver& deliver) {
    deliver_run(deliver);
    while (waiting_ > 0 && now - longest_wait_began() > timeout_ns_) skip_to_earliest(now, deliver);
  }

  [[nodiscard]] SteadyTime longest_wait_began() const {
    SteadyTime earliest = SteadyTime::max();
    for (const Place& place : places_) {
      if (place.taken && place.since < earliest) earliest = place.since;
    }
    return earliest;
  }

  TimeNs timeout_ns_;
  std::array<Place, capacity> places_{};
  std::size_t waiting_ = 0;
  std::uint64_t next_ = 0;
  bool started_ = false;
  int late_run_ = 0;
  std::uint64_t late_next_ = 0;
  std::array<Gap, 16> given_up_{};  ///< the latest
  std::size_t given_up_count_ = 0;
  CollatorCounters counters_;
};

}  // namespace sonopose::collation
