#pragma once
/// \file
/// Detects input events of the beacons that never arrived: DDS reports only samples that it drops itself.

#include "mcap/chunk.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <atomic>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

namespace sonopose::recorder {

/// Missing numbers of one numbering: the inputs of one beacon from one run of a bridge.
class EventNumbers {
public:
  /// Distance at which a missing number counts as lost. Topics are not ordered among each other, so numbers
  /// may arrive out of order; a lost number that arrives after all is subtracted again.
  static constexpr std::uint64_t settled_after = 256;
  static constexpr std::uint64_t window = 4096;
  /// Last numbers before the end: they may be in transit and do not count.
  static constexpr std::uint64_t under_way = 8;

  /// Starts a numbering. Numbers before the first one are not missing.
  explicit EventNumbers(std::uint64_t first) : first_(first), highest_(first) { received_.set(); }

  /// True if this number of the window has arrived.
  [[nodiscard]] bool has(std::uint64_t number) const {
    return number >= first_ && number <= highest_ && received_[index_of(number)];
  }
  /// True if a number can belong to this numbering.
  [[nodiscard]] bool contains(std::uint64_t number) const {
    return (number > highest_ ? number - highest_ : highest_ - number) < window;
  }
  void on(std::uint64_t number);
  /// Counts the numbers that are still open at the end, except the last few, which may be in transit.
  void finish();
  [[nodiscard]] std::uint64_t highest() const { return highest_; }
  [[nodiscard]] std::uint64_t missing() const { return missing_; }

private:
  [[nodiscard]] static std::size_t index_of(std::uint64_t number) { return number % window; }

  std::uint64_t first_;
  std::uint64_t highest_;
  std::uint64_t missing_ = 0;
  std::bitset<window> received_;  ///< arrival of the latest numbers
};

/// Counts the missing events of all beacons. One thread writes; any thread may read the count.
class EventGaps {
public:
  /// `channel_ids`: channels of imu, fix, heading and twist, whose events are numbered together. If one is 0,
  /// it is not recorded, and nothing is counted.
  explicit EventGaps(std::array<std::uint16_t, 4> channel_ids) : channel_ids_(channel_ids) {}

  void on(const mcap::Chunk& chunk);
  /// Counts the numbers that are still open, at the end.
  void finish();
  [[nodiscard]] std::uint64_t missing() const { return missing_; }

private:
  /// The latest two numberings of one beacon. A number far ahead starts another numbering, and the numbers
  /// between are missing. If the previous numbering continues, two bridges share the beacon, and nothing is
  /// missing.
  struct Beacon {
    EventNumbers latest;
    std::optional<EventNumbers> before{};
    std::uint64_t gap_between = 0;  ///< counted as missing between the two numberings
    std::uint64_t repeated = 0;     ///< latest of consecutive numbers that came before
    unsigned repeated_count = 0;
  };

  static constexpr std::uint64_t max_gap = 10'000'000;  ///< largest step ahead that counts as loss

  void on(BeaconAddress address, std::uint64_t number);
  void choose_numbering(Beacon& beacon, std::uint64_t number);
  static bool numbering_restarted(Beacon& beacon, std::uint64_t number);
  void begin_numbering(Beacon& beacon, std::uint64_t first);
  void finish(EventNumbers& numbers);

  std::array<std::uint16_t, 4> channel_ids_;
  std::map<BeaconAddress, Beacon> beacons_;
  std::atomic<std::uint64_t> missing_ = 0;
};

}  // namespace sonopose::recorder
