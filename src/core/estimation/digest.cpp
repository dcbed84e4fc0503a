#include "estimation/digest.hpp"

#include <sonopose/estimation/snapshot_fields.hpp>

#include <bit>
#include <string_view>
#include <type_traits>

namespace sonopose::estimation {
namespace {

/// Adds the fields of a state, of every type.
struct FieldDigest {
  Digest& digest;

  void operator()(const char* /*name*/, double value) const { digest.add(value); }
  void operator()(const char* /*name*/, bool value) const { digest.add(std::uint64_t{value}); }
  void operator()(const char* /*name*/, int value) const { digest.add(static_cast<std::uint64_t>(value)); }
  void operator()(const char* /*name*/, TimeNs value) const { digest.add(static_cast<std::uint64_t>(value)); }
  template <class Enum>
  requires std::is_enum_v<Enum>
  void operator()(const char* /*name*/, Enum value) const { digest.add(static_cast<std::uint64_t>(value)); }
  void operator()(const char* /*name*/, const Vector3d& value) const {
    for (const double component : value) digest.add(component);
  }
  void operator()(const char* /*name*/, const Quaterniond& q) const {
    for (const double component : q.coeffs()) digest.add(component);
  }
  template <int size>
  void operator()(const char* /*name*/, const Eigen::Matrix<double, size, size>& value) const {
    for (const double component : value.reshaped()) digest.add(component);
  }
  void operator()(const char* name, attitude::AnyFilter filter) const {
    (*this)(name, static_cast<int>(filter.kind()));
    filter.for_each_field(*this);
  }
  template <class Record>
  requires requires(const Record& record) {
    for_each_field(record, [](const char*, const auto&) {});
  }
  void operator()(const char* /*name*/, const Record& record) const { for_each_field(record, *this); }
  template <class Sequence>
  requires std::is_class_v<typename Sequence::value_type>
  void operator()(const char* /*name*/, const Sequence& records) const {
    for (std::size_t i = 0; i < records.size(); ++i) for_each_field(records[i], *this);
  }
};

}  // namespace

void Digest::add(std::uint64_t word) {
  value_ = (value_ ^ word) * 0x100000001B3U;
  value_ ^= value_ >> 32U;  // a product alone never carries a word's high bits down
}

void Digest::add(double value) {
  add(std::bit_cast<std::uint64_t>(value));
}

void Digest::add(const FusedPose& pose) {
  add(static_cast<std::uint64_t>(pose.time_ns));
  for (const double component : pose.position_world_m) add(component);
  for (const double component : pose.q_body_to_world.coeffs()) add(component);
  for (const double component : pose.velocity_world_mps) add(component);
  constexpr std::uint64_t of_sensor_faults = status_imu_inconsistent | status_fixes_inconsistent;
  add(pose.status & ~of_sensor_faults);
}

void Digest::add(const AnySnapshot& snapshot) {
  for_each_field(snapshot, FieldDigest{*this});
}

std::string Digest::text() const {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (int shift = 60; shift >= 0; shift -= 4) text += digits[value_ >> static_cast<unsigned>(shift) & 15U];
  return text;
}

}  // namespace sonopose::estimation
