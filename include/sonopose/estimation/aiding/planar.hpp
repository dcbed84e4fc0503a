#pragma once
/// \file
/// A body that stays in a horizontal plane, for all engines.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::aiding {

/// True if the height of fixes is not used: the body is held at that of the settings.
constexpr bool ignores_height(const settings::PlanarSettings& settings) {
  return settings.planar && settings.height_from == settings::HeightSource::setting;
}

/// The position of a fix, with the height at which its point of the level body is held in place of an ignored
/// one.
Vector3d position_in_plane(const settings::PlanarSettings& settings, const Vector3d& position_world_m,
                           const Vector3d& point_body_m);

/// Sets height, roll, pitch, their rates and vertical motion to 0, if the settings demand it. The covariance
/// stays.
void flatten(const settings::PlanarSettings& settings, FusedPose& pose);

}  // namespace sonopose::estimation::aiding
