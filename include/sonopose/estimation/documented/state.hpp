#pragma once
/// \file
/// The state of one engine, with one group per stage. It is a plain value.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/aiding/default_position.hpp>
#include <sonopose/estimation/documented/alignment.hpp>
#include <sonopose/estimation/documented/drift.hpp>
#include <sonopose/estimation/documented/frozen.hpp>
#include <sonopose/estimation/documented/heading.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/estimation/documented/outage.hpp>
#include <sonopose/estimation/documented/runaway.hpp>
#include <sonopose/estimation/documented/scatter.hpp>
#include <sonopose/estimation/documented/startup.hpp>
#include <sonopose/estimation/documented/trust.hpp>
#include <sonopose/estimation/documented/uncertainty.hpp>
#include <sonopose/estimation/documented/velocity.hpp>
#include <sonopose/samples/estimator_counters.hpp>

#include <cstdint>

namespace sonopose::estimation::documented {

struct State {
  Kinematics body;
  attitude::AnyFilter filter;
  StartupState startup;
  aiding::AdmissionState admission;
  aiding::DefaultPosition default_position;
  FrozenState frozen;
  ScatterState scatter;
  TrustState trust;
  DriftState drift;
  VelocityState velocity;
  AlignmentState alignment;
  HeadingState heading;
  OutageState outage;
  RunawayState runaway;
  UncertaintyState uncertainty;
  Vector3d previous_rate_body_radps = Vector3d::Zero();  ///< rate of the previous sample, without the offset
  bool in_imu_gap = false;                               ///< true if the latest sample followed a silence

  bool operator==(const State&) const = default;
};

/// Everything in an engine except its settings. An engine restored from it with the same settings computes
/// the same bits.
struct Snapshot {
  State state;
  EstimatorCounters counters;
  std::uint32_t reset_counter = 0;

  bool operator==(const Snapshot&) const = default;
};

}  // namespace sonopose::estimation::documented
