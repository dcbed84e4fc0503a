#pragma once
/// \file
/// The messages of MAVLink's dialect "common" that an external estimator exchanges with an autopilot.
/// Source: message_definitions/v1.0/common.xml and minimal.xml. Fields are in the order of the wire: by
/// size, then extensions.

#include "autopilot/external_odometry.hpp"
#include "mavlink/frame.hpp"

#include <cstdint>
#include <optional>

namespace sonopose::mavlink {

/// MAV_AUTOPILOT: who sends a heartbeat.
inline constexpr std::uint8_t autopilot_ardupilot = 3;
inline constexpr std::uint8_t autopilot_none = 8;  ///< not a flight controller
inline constexpr std::uint8_t autopilot_px4 = 12;

/// MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY: our component on the vehicle.
inline constexpr std::uint8_t own_component = 197;

/// HEARTBEAT of an onboard computer that is active.
Frame heartbeat(Identity sender);

/// The autopilot that sent this heartbeat; empty for another message, or for one of no flight controller.
std::optional<std::uint8_t> autopilot_of(const Frame& frame);

/// Answer to a TIMESYNC request with our time; empty for another message, or for an answer.
std::optional<Frame> timesync_answer(const Frame& request, Identity sender, TimeNs now_ns);

/// Fields of a pose message that are not in ExternalOdometry.
struct PoseMessageFields {
  TimeNs time_ns = 0;   ///< stamp, in the clock of the answers to TIMESYNC
  bool in_ned = false;  ///< MAV_FRAME_LOCAL_NED, otherwise LOCAL_FRD, the only one that ArduPilot takes
  std::uint8_t reset_counter = 0;
  std::uint8_t quality_percent = 0;
};

/// ODOMETRY: the pose, with the velocity in body axes.
Frame odometry(const autopilot::ExternalOdometry& odometry, Identity sender, const PoseMessageFields& fields);

/// VISION_POSITION_ESTIMATE: the pose alone, without a quality.
Frame vision_position_estimate(const autopilot::ExternalOdometry& odometry, Identity sender,
                               const PoseMessageFields& fields);

}  // namespace sonopose::mavlink
