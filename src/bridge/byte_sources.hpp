#pragma once
/// \file
/// Sources that bring the bytes of Marvelmind beacons: a file of them, a serial line, UDP datagrams.

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

/// A file of raw bytes as a serial line would bring them. The beacons' own clock tells when each packet came,
/// so the same file gives the same samples every time; the first stamp is taken for now. Throws where the
/// file cannot be read.
std::unique_ptr<Source> make_stream_source(const StreamOptions& options);

struct SerialOptions {
  std::string device = "/dev/ttyACM0";
  std::uint32_t baud = 500'000;
};

/// A serial line. A device that is absent or unplugged is waited for. `capture` keeps the raw bytes.
std::unique_ptr<Source> make_serial_source(const SerialOptions& options,
                                           const std::optional<std::filesystem::path>& capture);

/// Datagrams that arrive at `listen` (ADDR:PORT). `capture` keeps them, one after the other. Throws
/// std::invalid_argument for an address that is none, std::system_error where it cannot be bound.
std::unique_ptr<Source> make_udp_source(const std::string& listen,
                                        const std::optional<std::filesystem::path>& capture);

}  // namespace sonopose::bridge
