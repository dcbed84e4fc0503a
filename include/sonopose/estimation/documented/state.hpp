#pragma once
/// \file
/// The whole state of one engine, a group per stage. It can be read and copied; a copy goes on as the
/// original would.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/estimation/documented/admission.hpp>
#include <sonopose/estimation/documented/alignment.hpp>
#include <sonopose/estimation/documented/drift.hpp>
#include <sonopose/estimation/documented/frozen.hpp>
#include <sonopose/estimation/documented/heading.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/outage.hpp>
#include <sonopose/estimation/documented/runaway.hpp>
#include <sonopose/estimation/documented/startup.hpp>
#include <sonopose/estimation/documented/trust.hpp>
#include <sonopose/estimation/documented/uncertainty.hpp>
#include <sonopose/estimation/documented/velocity.hpp>

#include <cstdint>

namespace sonopose::estimation::documented {

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

}  // namespace sonopose::estimation::documented
