#pragma once
/// \file
/// The columns of a sensor log, shared by reader and writer.

#include "csv/layout.hpp"

#include <array>
#include <cstddef>
#include <string_view>

namespace sonopose::recording {

inline constexpr std::string_view imu_file = "imu.csv";
inline constexpr std::string_view ultrasonic_file = "ultrasonic.csv";
inline constexpr std::string_view heading_file = "heading.csv";
inline constexpr std::string_view twist_file = "twist.csv";
inline constexpr std::string_view truth_file = "truth.csv";
inline constexpr std::string_view wheel_speed_file = "wheel_speed.csv";
inline constexpr std::string_view movement_file = "movement.csv";
inline constexpr std::string_view meta_file = "meta.toml";
// Tables that a replay writes, which no program reads.
inline constexpr std::string_view pose_file = "pose.csv";
inline constexpr std::string_view fixes_file = "fixes.csv";
inline constexpr std::string_view covariance_file = "covariance.csv";

inline constexpr std::array<std::string_view, 10> imu_columns{
    "timestamp [ns]", "w_x [rad s^-1]", "w_y [rad s^-1]", "w_z [rad s^-1]", "a_x [m s^-2]",
    "a_y [m s^-2]",   "a_z [m s^-2]",   "m_x [uT]",       "m_y [uT]",       "m_z [uT]"};
inline constexpr std::size_t imu_columns_without_magnetometer = 7;  ///< required columns

inline constexpr std::array<std::string_view, 6> ultrasonic_columns{
    "timestamp [ns]", "received [ns]", "x [m]", "y [m]", "z [m]", "quality [%]"};
inline constexpr std::size_t ultrasonic_columns_required = 5;

inline constexpr std::array<std::string_view, 3> heading_columns{"timestamp [ns]", "received [ns]",
                                                                 "heading [deg]"};

inline constexpr std::array<std::string_view, 11> twist_columns{
    "timestamp [ns]", "received [ns]",  "v_x [m s^-1]",   "v_y [m s^-1]",   "v_z [m s^-1]",  "std_x [m s^-1]",
    "std_y [m s^-1]", "std_z [m s^-1]", "w_x [rad s^-1]", "w_y [rad s^-1]", "w_z [rad s^-1]"};
inline constexpr std::size_t twist_columns_required = 5;  ///< columns up to the velocity

inline constexpr std::array<std::string_view, 17> truth_columns{
    "timestamp [ns]", "p_x [m]",          "p_y [m]",          "p_z [m]",          "q_w []",
    "q_x []",         "q_y []",           "q_z []",           "v_x [m s^-1]",     "v_y [m s^-1]",
    "v_z [m s^-1]",   "b_w_x [rad s^-1]", "b_w_y [rad s^-1]", "b_w_z [rad s^-1]", "b_a_x [m s^-2]",
    "b_a_y [m s^-2]", "b_a_z [m s^-2]"};
inline constexpr std::size_t truth_columns_required = 4;  ///< columns up to the position
inline constexpr std::size_t truth_columns_written = 11;  ///< columns up to the velocity

inline constexpr std::array<std::string_view, 2> wheel_speed_columns{"timestamp [ns]", "speed [m s^-1]"};

inline constexpr std::array<std::string_view, 2> movement_columns{"start [ns]", "end [ns]"};

/// Names of EuRoC's, TUM's and ROS' files, and those in general use.
inline constexpr auto column_synonyms = std::to_array<csv::ColumnSynonym>({
    {"time", "timestamp"},
    {"t", "timestamp"},
    {"stamp", "timestamp"},
    {"headerstamp", "timestamp"},
    {"zeit", "timestamp"},
    {"east", "px"},
    {"easting", "px"},
    {"north", "py"},
    {"northing", "py"},
    {"up", "pz"},
    {"tagid", "tag"},
    {"beacon", "tag"},
    {"beaconid", "tag"},
    {"hedgehog", "tag"},
    {"hedgehogid", "tag"},
    {"device", "tag"},
    {"deviceid", "tag"},
    {"id", "tag"},
    {"sensorid", "tag"},
    {"nodeid", "tag"},
    {"mac", "tag"},
    {"address", "tag"},
    {"*", "p*"},
    {"t*", "p*"},
    {"pos*", "p*"},
    {"position*", "p*"},
    {"point*", "p*"},
    {"translation*", "p*"},
    {"gyr*", "w*"},
    {"gyro*", "w*"},
    {"gyroscope*", "w*"},
    {"g*", "w*"},
    {"omega*", "w*"},
    {"angularvelocity*", "w*"},
    {"angvel*", "w*"},
    {"rate*", "w*"},
    {"angularrate*", "w*"},
    {"rotationrate*", "w*"},
    {"gyroskop*", "w*"},
    {"drehrate*", "w*"},
    {"acc*", "a*"},
    {"accel*", "a*"},
    {"accelerometer*", "a*"},
    {"acceleration*", "a*"},
    {"linearacceleration*", "a*"},
    {"linacc*", "a*"},
    {"specificforce*", "a*"},
    {"beschleunigung*", "a*"},
    {"mag*", "m*"},
    {"magnetometer*", "m*"},
    {"magneticfield*", "m*"},
    {"orientation*", "q*"},
    {"quaternion*", "q*"},
    {"quat*", "q*"},
    {"vel*", "v*"},
    {"velocity*", "v*"},
});

/// A file of these columns, of which the first `required` must be there.
constexpr csv::Layout layout_of(std::span<const std::string_view> columns, std::size_t required) {
  return {columns, required, column_synonyms};
}

inline constexpr csv::Layout imu_layout() {
  return layout_of(imu_columns, imu_columns_without_magnetometer);
}

inline constexpr csv::Layout truth_layout() {
  return layout_of(truth_columns, truth_columns_required);
}

}  // namespace sonopose::recording
