#include "evaluation/digest.hpp"

#include <sonopose/estimation/documented/state_fields.hpp>

#include <fmt/format.h>

#include <bit>

namespace sonopose::evaluation {
namespace {

/// Visitor that adds each field of a state to the digest.
struct FieldDigest {
  Digest& digest;

  void operator()(const char* /*name*/, double value) const { digest.add(value); }
  void operator()(const char* /*name*/, bool value) const { digest.add(std::uint64_t{value}); }
  void operator()(const char* /*name*/, int value) const { digest.add(static_cast<std::uint64_t>(value)); }
  void operator()(const char* /*name*/, TimeNs value) const { digest.add(static_cast<std::uint64_t>(value)); }
  void operator()(const char* /*name*/, estimation::documented::InitPhase value) const {
    digest.add(static_cast<std::uint64_t>(value));
  }
  void operator()(const char* /*name*/, const Vector3d& value) const {
    for (const double component : value) digest.add(component);
  }
  void operator()(const char* name, const estimation::documented::PastFix& fix) const {
    (*this)(name, fix.measured_ns);
    (*this)(name, fix.position_world_m);
  }
  void operator()(const char* /*name*/, const Quaterniond& q) const {
    for (const double component : q.coeffs()) digest.add(component);
  }
  void operator()(const char* /*name*/, const Eigen::Matrix3d& value) const {
    for (const double component : value.reshaped()) digest.add(component);
  }
  void operator()(const char* name, attitude::AnyFilter filter) const {
    (*this)(name, static_cast<int>(filter.kind()));
    filter.for_each_field(*this);
  }
  void operator()(const char* name, const estimation::documented::InertialHistory& history) const {
    for (std::size_t i = 0; i < history.size(); ++i) {
      (*this)(name, history[i].time_ns);
      (*this)(name, history[i].displacement_world_m);
      (*this)(name, history[i].yaw_rad);
    }
  }
};

}  // namespace

void Digest::add(std::uint64_t word) {
  value_ = (value_ ^ word) * 0x100000001B3U;
  value_ ^= value_ >> 32U;  // a product alone never propagates high bits to low ones
}

void Digest::add(double value) {
  add(std::bit_cast<std::uint64_t>(value));
}

void Digest::add(const FusedPose& pose) {
  add(static_cast<std::uint64_t>(pose.time_ns));
  for (const double component : pose.position_world_m) add(component);
  for (const double component : pose.q_body_to_world.coeffs()) add(component);
  for (const double component : pose.velocity_world_mps) add(component);
  add(std::uint64_t{pose.status});
}

void Digest::add(const estimation::documented::State& state) {
  estimation::documented::for_each_field(state, FieldDigest{*this});
}

std::string Digest::text() const {
  return fmt::format("{:016x}", value_);
}

}  // namespace sonopose::evaluation
