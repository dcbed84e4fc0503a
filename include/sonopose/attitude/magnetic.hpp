#pragma once
/// \file
/// Which field is the Earth's: a reference of its norm and dip is learned, and a field that differs from it
/// is not asked for north.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/settings/declaration.hpp>

namespace sonopose::attitude {

struct MagneticSettings {
  double norm_tolerance{};
  double dip_tolerance_deg{};
  double undisturbed_s{};
  double first_field_s{};
  double new_field_s{};
  double new_field_rate_dps{};
  double longest_rejection_s{};
  double late_share{};
  double reference_s{};
  double smoothing_s{};

  static constexpr std::string_view group = "attitude.magnetic";
  static constexpr auto declarations() {
    using G = MagneticSettings;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(own_setting, "norm_tolerance", &G::norm_tolerance, 0.1, {0.0, 1.0}, "",
             "A field is disturbed whose norm differs from the reference by more than this share."),
        real(own_setting, "dip_tolerance_deg", &G::dip_tolerance_deg, 10.0, {0.0, 90.0}, "deg",
             "A field is disturbed whose dip differs from the reference by more than this."),
        real(own_setting, "undisturbed_s", &G::undisturbed_s, 0.5, {0.0, 60.0}, "s",
             "A field counts as the reference again when it has been like it for this long."),
        real(own_setting, "first_field_s", &G::first_field_s, 5.0, {0.0, 600.0}, "s",
             "The first reference is a field that has stayed the same for this long while the body turned."),
        real(own_setting, "new_field_s", &G::new_field_s, 20.0, {0.0, 600.0}, "s",
             "Another field becomes the reference when it has stayed the same for this long while the body "
             "turned."),
        real(own_setting, "new_field_rate_dps", &G::new_field_rate_dps, 20.0, {0.0, 1000.0}, "deg/s",
             "The body turns, for these times, when its rate is above this: at rest a magnet beside it looks "
             "like a field of the place."),
        real(own_setting, "longest_rejection_s", &G::longest_rejection_s, 60.0, {0.0, 3600.0}, "s",
             "A disturbed field is not used for so long at most, then with the share late_share."),
        real(own_setting, "late_share", &G::late_share, 0.1, {0.0, 1.0}, "",
             "How much a disturbed field counts when it has lasted longer than that."),
        real(own_setting, "reference_s", &G::reference_s, 20.0, {0.1, 3600.0}, "s",
             "Time in which the reference follows an undisturbed field."),
        real(own_setting, "smoothing_s", &G::smoothing_s, 0.05, {0.0, 10.0}, "s",
             "Time constant of the mean of norm and dip."));
  }
  constexpr MagneticSettings() { settings::set_defaults(*this); }
};

/// A field by its level and its vertical part, which a turn about the vertical leaves as they are.
template <class Scalar>
struct FieldShape {
  Scalar level_t = 0;
  Scalar up_t = 0;

  bool operator==(const FieldShape&) const = default;
};

template <class Scalar>
struct MagneticState {
  FieldShape<Scalar> mean;
  Scalar mean_age_s = 0;
  FieldShape<Scalar> reference;
  bool has_reference = false;
  FieldShape<Scalar> candidate;   ///< what may become the reference
  Scalar candidate_age_s = 0;     ///< how long it has stayed the same, up to reference_s
  Scalar candidate_turned_s = 0;  ///< of that, how long the body turned
  Scalar like_reference_s = 0;
  bool disturbed = true;
  Scalar rejected_s = 0;  ///< how long disturbed fields have not been used, less undisturbed time

  bool operator==(const MagneticState&) const = default;
};

namespace magnetic {

/// Takes one field in, turned into the world; `rate_radps` is how fast the body turns. Returns its weight for
/// the heading: 1 undisturbed, 0 disturbed, `late_share` where the disturbance will not end.
template <class Scalar>
Scalar weigh(const MagneticSettings& settings, MagneticState<Scalar>& state,
             const Vector3<Scalar>& field_world_t, Scalar rate_radps, Scalar dt_s);

}  // namespace magnetic
}  // namespace sonopose::attitude
