#pragma once
/// \file
/// Input events of the beacons that never arrived: DDS reports only what it drops itself.

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

/// The numbers that are missing in one numbering: that of one beacon's inputs by one run of a bridge.
class EventNumbers {
public:
  /// Numbers that arrive in another order, since the topics have no order between them. A number that is
  /// missing counts when so many later ones have arrived, and not any more if it arrives after all.
  static constexpr std::uint64_t settled_after = 256;
  static constexpr std::uint64_t window = 4096;
  /// The last numbers before the end, which may be under way and do not count.
  static constexpr std::uint64_t under_way = 8;

  /// What was before the first number is not missing.
  explicit EventNumbers(std::uint64_t first) : first_(first), highest_(first) { received_.set(); }

  /// Whether this number of the window has arrived.
  [[nodiscard]] bool has(std::uint64_t number) const {
    return number >= first_ && number <= highest_ && received_[index_of(number)];
  }
  /// Whether a number can be of this numbering.
  [[nodiscard]] bool contains(std::uint64_t number) const {
    return (number > highest_ ? number - highest_ : highest_ - number) < window;
  }
  void on(std::uint64_t number);
  /// Nothing more comes: counts what is not settled, but for the last few, which may be under way.
  void finish();
  [[nodiscard]] std::uint64_t highest() const { return highest_; }
  [[nodiscard]] std::uint64_t missing() const { return missing_; }

private:
  [[nodiscard]] static std::size_t index_of(std::uint64_t number) { return number % window; }

  std::uint64_t first_;
  std::uint64_t highest_;
  std::uint64_t missing_ = 0;
  std::bitset<window> received_;  ///< of the latest numbers
};

/// Counts the missing events of all beacons. One thread writes; the count may be read from any thread.
class EventGaps {
public:
  /// The channels of imu, fix and heading, whose events are numbered together. If one of them is 0, it is
  /// not recorded, and nothing is counted.
  explicit EventGaps(std::array<std::uint16_t, 3> channel_ids) : channel_ids_(channel_ids) {}

  void on(const mcap::Chunk& chunk);
  /// Nothing more comes.
  void finish();
  [[nodiscard]] std::uint64_t missing() const { return missing_; }

private:
  /// The numberings of one beacon: the latest, and the one before. Events that are far ahead begin another
  /// numbering: what is between is missing, unless the one before goes on, because two bridges have the same
  /// beacon.
  struct Beacon {
    EventNumbers latest;
    std::optional<EventNumbers> before{};
    std::uint64_t gap_between = 0;  ///< counted as missing from the one before to the latest
    std::uint64_t repeated = 0;     ///< the latest of numbers in succession that came before
    unsigned repeated_count = 0;
  };

  static constexpr std::uint64_t longest_gap = 10'000'000;  ///< a step ahead by more is no loss

  void on(BeaconAddress address, std::uint64_t number);
  void choose_numbering(Beacon& beacon, std::uint64_t number);
  static bool begins_again(Beacon& beacon, std::uint64_t number);
  void begin_numbering(Beacon& beacon, std::uint64_t first);
  void finish(EventNumbers& numbers);

  std::array<std::uint16_t, 3> channel_ids_;
  std::map<BeaconAddress, Beacon> beacons_;
  std::atomic<std::uint64_t> missing_ = 0;
};

}  // namespace sonopose::recorder
