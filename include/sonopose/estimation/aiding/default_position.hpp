#pragma once
/// \file
/// The default position, which the document does not mention: a position that a source reports when it has
/// none. Both engines detect it in the same way.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>

namespace sonopose::estimation::aiding {

/// True if two positions have equal coordinates at the resolution of a beacon.
[[nodiscard]] bool is_same_position(const Vector3d& a_world_m, const Vector3d& b_world_m);

/// Detects a position that the source reports instead of a solution: the fixes leave it by decimetres and
/// return to it to the millimetre.
struct DefaultPosition {
  static constexpr std::size_t capacity = 8;
  struct Coordinates {
    Vector3d position_world_m = Vector3d::Zero();
    bool operator==(const Coordinates&) const = default;
  };
  std::array<Coordinates, capacity> recent;  ///< latest fixes
  int fixes = 0;                             ///< number of fixes so far, modulo a multiple of the capacity
  bool is_known = false;
  Vector3d default_world_m = Vector3d::Zero();
  TimeNs seen_ns = 0;  ///< time of its last report
  int in_row = 0;      ///< consecutive fixes at it, up to the latest

  /// Adds a fix. Returns true if it is the default position.
  bool add(TimeNs time_ns, const Vector3d& position_world_m);
  /// True if it was reported in the last seconds.
  [[nodiscard]] bool is_active(TimeNs now_ns) const;
  bool operator==(const DefaultPosition&) const = default;
};

void for_each_field(IsFieldsOf<DefaultPosition::Coordinates> auto& coordinates, const auto& visit) {
  visit("position_world_m", coordinates.position_world_m);
}

void for_each_field(IsFieldsOf<DefaultPosition> auto& position, const auto& visit) {
  visit("recent", position.recent);
  visit("fixes", position.fixes);
  visit("is_known", position.is_known);
  visit("default_world_m", position.default_world_m);
  visit("seen_ns", position.seen_ns);
  visit("in_row", position.in_row);
}

}  // namespace sonopose::estimation::aiding
