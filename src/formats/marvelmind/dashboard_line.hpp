#pragma once
/// \file
/// Parses a line of a CSV log of the vendor's Dashboard (version 7 and later), `*__Marvelmind_log.csv`:
///
///     TYYYY_MM_DD__hhmmss_mmm,user,41,CODE,address,…
///
/// | CODE | after the address |
/// |---|---|
/// | 17, 129 | x, y, z [m], flags, angle word, time passed [ms] |
/// | 3, 131 | accelerometer, gyroscope and compass x, y, z, as in RawImu |
/// | 7 | quality [%], zone |
///
/// `na` and `nl` stand for a value that is not applicable or not licensed. Other lines have no packet.

#include "marvelmind/packet.hpp"
#include <sonopose/samples/time.hpp>

#include <string_view>

namespace sonopose::marvelmind {

struct DashboardLine {
  enum class Kind { packet, other, invalid };

  Kind kind = Kind::other;
  TimeNs time_ns = 0;          ///< time of the line in the clock of the Dashboard's host, read as UTC
  Packet packet{};             ///< packet with a unix timestamp
  std::string_view problem{};  ///< wrong field of an invalid line
};

DashboardLine parse_dashboard_line(std::string_view line);

}  // namespace sonopose::marvelmind
