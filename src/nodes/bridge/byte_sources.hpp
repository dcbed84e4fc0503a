#pragma once
/// \file
/// Sources of Marvelmind beacon bytes: a file, a serial line, UDP datagrams.

#include "presence/beacon_admission.hpp"
#include "publication/source.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace sonopose::bridge {

/// Default meaning of IMU samples. The protocol does not define it, and firmware may differ.
inline constexpr ImuMeaning default_imu_meaning = ImuMeaning::unknown;

struct StreamOptions {
  std::filesystem::path file;
  double rate = 1;
  ImuMeaning imu_meaning = default_imu_meaning;
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;
};

/// A file of raw bytes from a serial line. The beacons' own clock times each packet, so a file always gives
/// the same samples. The first stamp becomes the start time. Throws files::IoError if the file cannot be
/// read, has no valid frame or, while running, has no sample or more beacons than `max_beacons`.
std::unique_ptr<publication::Source> make_stream_source(const StreamOptions& options);

struct SerialOptions {
  std::string device = "/dev/ttyACM0";
  std::uint32_t baud = 500'000;
};

/// Options of every live line.
struct LiveOptions {
  std::optional<std::filesystem::path> capture = {};  ///< file for the raw bytes
  ImuMeaning imu_meaning = default_imu_meaning;
  std::size_t max_beacons =
      presence::BeaconAdmission::default_max_beacons;  ///< most beacons at a time; others are refused
};

/// A serial line. Waits for an absent or unplugged device. Throws std::invalid_argument for a path that is no
/// device.
std::unique_ptr<publication::Source> make_serial_source(const SerialOptions& options,
                                                        const LiveOptions& live);

struct UdpOptions {
  std::string listen = "0.0.0.0:49100";  ///< ADDR:PORT
  std::optional<std::string> from = {};  ///< only accepted sender address; empty: any
};

/// Datagrams, captured one after the other. Each beacon has one sender; packets from others are refused and
/// counted. Throws std::invalid_argument for an address that is malformed or needs rights, files::IoError if
/// it cannot be bound otherwise.
std::unique_ptr<publication::Source> make_udp_source(const UdpOptions& options, const LiveOptions& live);

}  // namespace sonopose::bridge
