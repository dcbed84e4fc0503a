#pragma once
/// \file
/// The attitude filter selected at run time (setting documented.attitude.filter). It satisfies Filter, so it
/// is used like any other filter.

#include <sonopose/attitude/adaptive.hpp>
#include <sonopose/attitude/ahrs.hpp>
#include <sonopose/attitude/complementary.hpp>
#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/gyro.hpp>
#include <sonopose/attitude/mahony.hpp>
#include <sonopose/attitude/settings.hpp>
#include <sonopose/attitude/tracker.hpp>

#include <variant>

namespace sonopose::attitude {

/// True if the chosen filter takes heading from the magnetometer.
bool has_magnetic_heading(const SelectionSettings& settings);

/// Extracts the use of the magnetometer from the settings.
FieldUse field_use(const SelectionSettings& settings);

class AnyFilter {
public:
  using Scalar = double;
  using Settings = attitude::Settings;
  static constexpr std::string_view name = "any";

  /// Resets the filter and keeps its kind.
  void reset(const Quaterniond& q_body_to_world);

  /// Performs one step. If the settings now select another filter, it starts with the orientation and
  /// gyroscope offset of the previous one. The AHRS then initialises, as after every reset.
  void update(const Settings& all, const Measurement<double>& measurement);

  void turn_in_world(const Vector3d& rotation_world_rad);
  void set_gyro_bias(const Vector3d& bias_body_radps);
  [[nodiscard]] Quaterniond orientation() const;
  [[nodiscard]] Vector3d gyro_bias_body_radps() const;

  [[nodiscard]] FilterKind kind() const { return static_cast<FilterKind>(filter_.index()); }
  void select(FilterKind kind);

  template <class Visit>
  void for_each_field(const Visit& visit) {
    std::visit([&visit](auto& filter) { filter.for_each_field(visit); }, filter_);
  }

  bool operator==(const AnyFilter&) const = default;

private:
  // Alternatives in the order of FilterKind.
  std::variant<Adaptive, Mahony, Complementary, Ahrs, Gyro> filter_;
};

}  // namespace sonopose::attitude
