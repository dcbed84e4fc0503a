#pragma once
/// \file
/// Detection of the Earth's magnetic field. The norm and dip of a reference field are learned; a field that
/// differs from it is not used for the heading.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

/// Level and vertical parts of a field, which a turn about the vertical preserves.
template <class Scalar>
struct FieldComponents {
  Scalar level_t = 0;
  Scalar up_t = 0;

  bool operator==(const FieldComponents&) const = default;
};

template <class Scalar>
struct MagneticState {
  FieldComponents<Scalar> mean;
  Scalar mean_age_s = 0;
  FieldComponents<Scalar> reference;
  bool has_reference = false;
  FieldComponents<Scalar> candidate;  ///< possible next reference
  Scalar candidate_age_s = 0;         ///< time for which the candidate has stayed the same, up to reference_s
  Scalar candidate_turned_s = 0;      ///< part of that time in which the body turned
  Scalar like_reference_s = 0;
  bool disturbed = true;
  Scalar rejected_s = 0;  ///< time for which disturbed fields were not used, less undisturbed time

  bool operator==(const MagneticState&) const = default;
};

namespace magnetic {

/// Adds one field in world axes; `rate_radps` is the body's angular rate. Returns the field's weight for the
/// heading: 1 undisturbed, 0 disturbed, `late_share` if the disturbance lasts too long.
template <class Scalar>
Scalar update(const MagneticSettings& settings, MagneticState<Scalar>& state,
              const Vector3<Scalar>& field_world_t, Scalar rate_radps, Scalar dt_s);

}  // namespace magnetic
}  // namespace sonopose::attitude
