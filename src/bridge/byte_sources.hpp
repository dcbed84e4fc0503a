#pragma once
/// \file
/// Sources of Marvelmind beacon bytes: a file, a serial line, UDP datagrams.

#include "bridge/source.hpp"
#include "process/beacon_admission.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace sonopose::bridge {

/// The protocol does not say what an IMU sample refers to, and firmware may differ.
inline constexpr ImuMeaning default_imu_meaning = ImuMeaning::unknown;

struct StreamOptions {
  std::filesystem::path file;
  double rate = 1;
  ImuMeaning imu_meaning = default_imu_meaning;
  std::size_t max_beacons = process::BeaconAdmission::default_max_beacons;
};

/// A file of raw bytes as received from a serial line. The beacons' own clock gives the time of each packet,
/// so the same file always gives the same samples; the first stamp becomes the time of the start. Throws
/// files::IoError if the file cannot be read, or, while it runs, if it has more beacons than `max_beacons`.
std::unique_ptr<Source> make_stream_source(const StreamOptions& options);

struct SerialOptions {
  std::string device = "/dev/ttyACM0";
  std::uint32_t baud = 500'000;
};

/// What the sources of a live line have in common.
struct LiveOptions {
  std::optional<std::filesystem::path> capture = {};  ///< file for the raw bytes
  ImuMeaning imu_meaning = default_imu_meaning;
  std::size_t max_beacons = process::BeaconAdmission::default_max_beacons;  ///< at a time; others are refused
};

/// A serial line. Waits for a device that is absent or unplugged. Throws files::IoError for a path that is no
/// device.
std::unique_ptr<Source> make_serial_source(const SerialOptions& options, const LiveOptions& live);

struct UdpOptions {
  std::string listen = "0.0.0.0:49100";  ///< ADDR:PORT
  std::optional<std::string> from = {};  ///< the only address to accept datagrams from
};

/// Datagrams, captured one after the other. Each beacon has one sender; packets of another one are refused
/// and counted. Throws std::invalid_argument for a malformed address, files::IoError if it cannot be bound.
std::unique_ptr<Source> make_udp_source(const UdpOptions& options, const LiveOptions& live);

}  // namespace sonopose::bridge
