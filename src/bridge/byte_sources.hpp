#pragma once
/// \file
/// Sources of Marvelmind beacon bytes: a file, a serial line, UDP datagrams.

#include "bridge/source.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace sonopose::bridge {

struct StreamOptions {
  std::filesystem::path file;
  double rate = 1;
};

/// A file of raw bytes as received from a serial line. The beacons' own clock gives the time of each packet,
/// so the same file always gives the same samples; the first stamp becomes the time of the start. Throws
/// files::IoError if the file cannot be read.
std::unique_ptr<Source> make_stream_source(const StreamOptions& options);

struct SerialOptions {
  std::string device = "/dev/ttyACM0";
  std::uint32_t baud = 500'000;
};

/// A serial line. Waits for a device that is absent or unplugged. Writes the raw bytes to `capture`. Throws
/// files::IoError for a path that is no device.
std::unique_ptr<Source> make_serial_source(const SerialOptions& options,
                                           const std::optional<std::filesystem::path>& capture);

/// Datagrams received at `listen` (ADDR:PORT), written to `capture` one after the other. Throws
/// std::invalid_argument for a malformed address, files::IoError if it cannot be bound.
std::unique_ptr<Source> make_udp_source(const std::string& listen,
                                        const std::optional<std::filesystem::path>& capture);

}  // namespace sonopose::bridge
