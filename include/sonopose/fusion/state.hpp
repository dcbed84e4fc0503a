#pragma once
/// \file
/// The whole state of one engine, a group per stage. It can be read and copied; a copy goes on as the
/// original would.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/fusion/admission.hpp>
#include <sonopose/fusion/alignment.hpp>
#include <sonopose/fusion/drift.hpp>
#include <sonopose/fusion/frozen.hpp>
#include <sonopose/fusion/heading.hpp>
#include <sonopose/fusion/kinematics.hpp>
#include <sonopose/fusion/outage.hpp>
#include <sonopose/fusion/runaway.hpp>
#include <sonopose/fusion/startup.hpp>
#include <sonopose/fusion/trust.hpp>
#include <sonopose/fusion/uncertainty.hpp>
#include <sonopose/fusion/velocity.hpp>

#include <cstdint>

namespace sonopose::fusion {

/// What has been counted since the engine was made; a reset does not clear it.
struct Counters {
  std::uint64_t imu_samples = 0;
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_rejected = 0;
  std::uint64_t headings = 0;
  std::uint64_t samples_invalid = 0;
  std::uint64_t imu_gaps = 0;

  bool operator==(const Counters&) const = default;
};

struct State {
  Kinematics body;
  attitude::AnyFilter filter;
  StartupState startup;
  AdmissionState admission;
  FrozenState frozen;
  TrustState trust;
  DriftState drift;
  VelocityState velocity;
  AlignmentState alignment;
  HeadingState heading;
  OutageState outage;
  RunawayState runaway;
  UncertaintyState uncertainty;
  Vector3d previous_rate_body_radps = Vector3d::Zero();  ///< of the sample before, offset off
  bool in_imu_gap = false;                               ///< the latest sample came after a silence

  bool operator==(const State&) const = default;
};

/// All that an engine knows besides its settings: another engine with these settings and this snapshot goes
/// on to the same bits.
struct Snapshot {
  State state;
  Counters counters;
  std::uint32_t reset_counter = 0;

  bool operator==(const Snapshot&) const = default;
};

}  // namespace sonopose::fusion
