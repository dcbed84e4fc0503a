#pragma once
/// \file
/// Triggers that make a recorder write the last seconds that it keeps in memory.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <atomic>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonopose::recorder {

enum class TriggerCause : std::uint8_t { none, signal, topic, status };

/// Text for people and for the file's metadata, such as "a signal".
const char* text_of(TriggerCause cause);

/// Fired by any thread, taken by one.
class Trigger {
public:
  /// Fires. The first cause counts until it is taken.
  void fire(TriggerCause cause) noexcept {
    TriggerCause none = TriggerCause::none;
    cause_.compare_exchange_strong(none, cause);
  }
  TriggerCause take() noexcept { return cause_.exchange(TriggerCause::none); }

private:
  std::atomic<TriggerCause> cause_ = TriggerCause::none;
};

/// Sees the samples of one topic, on the receive thread.
class TopicTrigger {
public:
  TopicTrigger() = default;
  TopicTrigger(const TopicTrigger&) = delete;
  TopicTrigger& operator=(const TopicTrigger&) = delete;
  virtual ~TopicTrigger() = default;
  virtual void on_sample(std::span<const std::byte> sample) noexcept = 0;
};

/// Fires at every sample.
class AnySampleTrigger final : public TopicTrigger {
public:
  explicit AnySampleTrigger(Trigger& trigger) : trigger_(trigger) {}
  void on_sample(std::span<const std::byte> /*sample*/) noexcept override {
    trigger_.fire(TriggerCause::topic);
  }

private:
  Trigger& trigger_;
};

/// Status bits that poses of a healthy beacon lack.
inline constexpr std::uint32_t bad_status = status_stale | status_frozen_track | status_imu_gap |
                                            status_low_trust | status_late | status_overloaded |
                                            status_imu_inconsistent | status_fixes_inconsistent;

/// Fires when one of these bits appears in a beacon's poses and its previous pose had none.
class BadStatusTrigger final : public TopicTrigger {
public:
  explicit BadStatusTrigger(Trigger& trigger) : trigger_(trigger) {}
  void on_sample(std::span<const std::byte> pose) noexcept override;

private:
  Trigger& trigger_;
  std::bitset<all_beacons + 1UL> was_good_;
};

}  // namespace sonopose::recorder
