#pragma once
/// \file
/// The filter that is chosen at run time (setting attitude.filter). It is a Filter itself, so that whatever
/// takes one takes the choice too.

#include <sonopose/attitude/adaptive.hpp>
#include <sonopose/attitude/ahrs.hpp>
#include <sonopose/attitude/complementary.hpp>
#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/gyro.hpp>
#include <sonopose/attitude/mahony.hpp>
#include <sonopose/attitude/tracker.hpp>
#include <sonopose/settings/declaration.hpp>

#include <array>
#include <cstdint>
#include <variant>

namespace sonopose::attitude {

enum class FilterKind : std::uint8_t { adaptive, mahony, complementary, ahrs, gyro };

constexpr std::array<std::string_view, 5> choices_of(FilterKind /*kind*/) {
  return {Adaptive::name, Mahony::name, Complementary::name, Ahrs::name, Gyro::name};
}

struct SelectionSettings {
  FilterKind filter{};
  bool magnetometer{};
  double north_deg{};

  static constexpr std::string_view group = "attitude";
  static constexpr auto declarations() {
    using G = SelectionSettings;
    using settings::own_setting;
    return settings::rows(
        settings::choice(own_setting, "filter", &G::filter, FilterKind::adaptive,
                        "Which filter tells the attitude; items 29 and 30 are mahony's."),
        settings::flag(own_setting, "magnetometer", &G::magnetometer, false,
                      "Heading from the magnetometer, where samples have one; not beside paired beacons, "
                      "whose heading is better."),
        settings::real(
            own_setting, "north_deg", &G::north_deg, 90.0, {-360.0, 360.0}, "deg",
            "Direction of magnetic north in the world, counter-clockwise from +X: 90 where X is east, "
            "0 where X is north."));
  }
  constexpr SelectionSettings() { settings::set_defaults(*this); }
};

/// Which filter, and the settings of each.
struct Settings {
  SelectionSettings selection;
  Adaptive::Settings adaptive;
  Mahony::Settings mahony;
  Complementary::Settings complementary;
  Ahrs::Settings ahrs;
};

/// The chosen filter takes heading from the magnetometer.
bool has_magnetic_heading(const SelectionSettings& settings);

/// What the settings say of the magnetometer.
FieldUse field_use(const SelectionSettings& settings);

class AnyFilter {
public:
  using Scalar = double;
  using Settings = attitude::Settings;
  static constexpr std::string_view name = "any";

  /// Keeps the kind.
  void reset(const Quaterniond& q_body_to_world);

  /// Where the settings name another filter than the one that stood here, it begins with the orientation and
  /// the gyroscope's offset of that one. The AHRS initialises then, as it does after every reset.
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
  // In the order of FilterKind.
  std::variant<Adaptive, Mahony, Complementary, Ahrs, Gyro> filter_;
};

}  // namespace sonopose::attitude
