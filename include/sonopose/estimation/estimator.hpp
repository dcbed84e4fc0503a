#pragma once
/// \file
/// The interface of position estimators, which turn a beacon's events into poses and fix reports. Types that
/// satisfy it are interchangeable; AnyEstimator (any_estimator.hpp) selects one at run time.

#include <sonopose/samples/estimator_counters.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <concepts>
#include <cstdint>
#include <optional>
#include <variant>

namespace sonopose::estimation {

/// An estimator of one beacon's pose.
///
/// It is a deterministic value: the same settings and events give the same bits. An estimator restored from a
/// snapshot continues like the original. None of these functions throws, and none but `snapshot` allocates.
///
/// - `predict` integrates an IMU sample and returns the pose at it. It returns nothing for a sample that it
///   does not use, and counts an impossible one in `samples_invalid`. A pose is always finite.
/// - `correct` with a fix returns a report on it; FixFlag::fix_used is not set if the fix changed nothing.
/// - `finish_pending_work` does the work that the last event left, which the next one would have to do first.
///   It changes no pose, report or snapshot. Call it before `estimate`, which after a late fix may otherwise
///   be of that earlier time.
/// - `configure` replaces the settings and keeps the state. `settings` are the effective ones.
/// - `reset` discards the state, keeps the counters and increments `reset_counter`.
/// - `time_ns` is the time of the state; 0 before the first sample.
/// - `estimate` returns what the estimator has learned about the sensors, without address and process.
template <class T>
concept Estimator = std::copyable<T> && std::equality_comparable<typename T::Snapshot> &&
    requires(T estimator, const T& constant, const ImuSample& imu, const UltrasonicFix& fix,
             const PairHeading& heading, const TwistSample& twist, const settings::Settings& settings,
             const typename T::Snapshot& snapshot) {
  { estimator.predict(imu) }
  noexcept->std::same_as<std::optional<FusedPose>>;
  { estimator.correct(fix) }
  noexcept->std::same_as<FixReport>;
  { estimator.correct(heading) }
  noexcept->std::same_as<void>;
  { estimator.correct(twist) }
  noexcept->std::same_as<void>;
  { estimator.finish_pending_work() }
  noexcept->std::same_as<void>;
  { estimator.configure(settings) }
  noexcept->std::same_as<void>;
  { estimator.reset() }
  noexcept->std::same_as<void>;
  { estimator.restore(snapshot) }
  noexcept->std::same_as<void>;
  { constant.snapshot() } -> std::same_as<typename T::Snapshot>;
  { constant.settings() } -> std::same_as<const settings::Settings&>;
  { constant.counters() } -> std::same_as<const EstimatorCounters&>;
  { constant.reset_counter() } -> std::same_as<std::uint32_t>;
  { constant.time_ns() } -> std::same_as<TimeNs>;
  { constant.estimate() } -> std::same_as<Estimate>;
};

/// Output for one event: a pose for an IMU sample, a report for a fix, nothing for a heading, a
/// twist or an unused sample.
using EventResult = std::variant<std::monostate, FusedPose, FixReport>;

/// Passes an event to the estimator.
template <Estimator T>
EventResult process(T& estimator, const Event& event) noexcept {
  if (const auto* imu = std::get_if<ImuSample>(&event)) {
    if (const auto pose = estimator.predict(*imu)) return *pose;
    return {};
  }
  if (const auto* fix = std::get_if<UltrasonicFix>(&event)) return estimator.correct(*fix);
  if (const auto* heading = std::get_if<PairHeading>(&event)) estimator.correct(*heading);
  if (const auto* twist = std::get_if<TwistSample>(&event)) estimator.correct(*twist);
  return {};
}

}  // namespace sonopose::estimation
