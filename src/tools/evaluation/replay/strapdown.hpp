#pragma once
/// \file
/// The strapdown document ("State Estimation Using IMU Data"): position, velocity and orientation from the
/// IMU alone, integrated from a known start. The error grows without bound. It is a baseline that shows the
/// worth of an IMU without fixes.

#include <sonopose/samples/estimator_counters.hpp>
#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

namespace sonopose::estimation::strapdown {

/// Position, velocity and orientation at one moment: the document's p, v and q.
struct State {
  TimeNs time_ns = 0;  ///< time of the state; 0: that of the first IMU sample
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();

  bool operator==(const State&) const = default;
};

/// Values that are constant over a step from sample k−1 to sample k.
enum class Rule : std::uint8_t {
  previous,  ///< rate and specific force of sample k−1, as in the document: first order in the step
  mean       ///< mean of both samples, each force rotated by its own attitude: second order
};

constexpr std::array<std::string_view, 2> choices_of(Rule /*rule*/) {
  return {"previous", "mean"};
}

/// Everything in an engine except its settings.
struct Snapshot {
  State start;
  Rule rule = Rule::previous;
  State state;
  bool has_previous = false;  ///< true once a sample was processed; its rate and force follow
  Vector3d previous_angular_velocity_body_radps = Vector3d::Zero();
  Vector3d previous_specific_force_body_mps2 = Vector3d::Zero();
  TimeNs last_imu_ns = 0;  ///< stamp of that sample
  EstimatorCounters counters;
  std::uint32_t reset_counter = 0;

  bool operator==(const Snapshot&) const = default;
};

/// Integrates IMU samples and ignores fixes and headings. Satisfies estimation::Estimator. Uses the settings
/// groups admission and outage.
class Engine {
public:
  using Snapshot = strapdown::Snapshot;

  /// Starts from a known state (section 2) and normalises its quaternion.
  explicit Engine(const settings::Settings& settings, const State& start = {}, Rule rule = Rule::previous);

  void configure(const settings::Settings& settings) noexcept;

  /// One step to the sample's time:
  ///   p ← p + Δt·v + ½Δt²·(R(q)·a + g)   (1)
  ///   v ← v + Δt·(R(q)·a + g)            (2)
  ///   q ← q ⊗ exp(ω·Δt)                  (3, 4)
  /// The values are those of step k−1. The document writes the increment on the left of q; body rates and a
  /// body-to-world quaternion require the right. g is standard gravity, which the document rounds to 9.81.
  /// Returns nothing for a sample before the start, which only serves as sample k−1 of the first step.
  /// Without one, the first step uses the first sample for both.
  std::optional<FusedPose> predict(const ImuSample& imu) noexcept;

  /// Reports the fix as not used.
  FixReport correct(const UltrasonicFix& fix) noexcept;
  void correct(const PairHeading& /*heading*/) noexcept {}

  static void finish_pending_work() noexcept {}  // a correction leaves no work
  /// Returns to the start.
  void reset() noexcept;
  void restore(const Snapshot& snapshot) noexcept { now_ = snapshot; }
  [[nodiscard]] Snapshot snapshot() const { return now_; }

  [[nodiscard]] const settings::Settings& settings() const { return settings_; }
  [[nodiscard]] const State& state() const { return now_.state; }
  [[nodiscard]] TimeNs time_ns() const { return now_.last_imu_ns; }
  [[nodiscard]] Estimate estimate() const;  ///< contains only the time
  [[nodiscard]] const EstimatorCounters& counters() const { return now_.counters; }
  [[nodiscard]] std::uint32_t reset_counter() const { return now_.reset_counter; }

private:
  void integrate(const ImuSample& imu);

  settings::Settings settings_;
  Snapshot now_;
};

/// Calls `visit(name, field)` for each field of the state; `AnySnapshot` is Snapshot or const Snapshot.
template <class AnySnapshot, class Visit>
requires std::same_as<std::remove_const_t<AnySnapshot>, Snapshot>
void for_each_field(AnySnapshot& snapshot, const Visit& visit) {
  visit("start.time_ns", snapshot.start.time_ns);
  visit("start.position_world_m", snapshot.start.position_world_m);
  visit("start.velocity_world_mps", snapshot.start.velocity_world_mps);
  visit("start.q_body_to_world", snapshot.start.q_body_to_world);
  visit("rule", snapshot.rule);
  visit("time_ns", snapshot.state.time_ns);
  visit("position_world_m", snapshot.state.position_world_m);
  visit("velocity_world_mps", snapshot.state.velocity_world_mps);
  visit("q_body_to_world", snapshot.state.q_body_to_world);
  visit("has_previous", snapshot.has_previous);
  visit("previous_angular_velocity_body_radps", snapshot.previous_angular_velocity_body_radps);
  visit("previous_specific_force_body_mps2", snapshot.previous_specific_force_body_mps2);
  visit("last_imu_ns", snapshot.last_imu_ns);
}

/// Returns no fault: any value that the types allow is possible.
inline std::optional<FieldFault> find_fault(const Snapshot& /*snapshot*/) {
  return std::nullopt;
}

}  // namespace sonopose::estimation::strapdown
