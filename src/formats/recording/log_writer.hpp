#pragma once
/// \file
/// Writes a sensor-log folder (see log_folder.hpp) that reads back to the same bits.

#include "recording/log_meta.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <memory>
#include <optional>

namespace sonopose::csv {
class Writer;
}

namespace sonopose::recording {

/// The recording of one beacon. Writes whole lines a few times a second, so that a killed process loses less
/// than its last second. Rows keep the order of the calls.
///
/// The format omits sequence numbers (the reader renumbers), the flags of a fix, a measured delay other than
/// receipt − emission, the value of an invalid heading, and standard deviations of a measured rate.
///
/// `meta.toml` follows the samples: it has the address of the first one, and the common meaning of all IMU
/// samples, or unknown if they differ.
///
/// Not thread-safe. Every member throws files::IoError if a file cannot be written.
class SensorLogWriter {
public:
  /// Creates the folder if needed. Refuses one that already contains a recording. `settings` describe the
  /// source in `meta.toml`.
  explicit SensorLogWriter(std::filesystem::path folder, LogSettings settings = {});
  /// Writes the remaining lines, and warns of magnetic fields that were dropped. Call flush() first to detect
  /// errors.
  ~SensorLogWriter();
  SensorLogWriter(const SensorLogWriter&) = delete;
  SensorLogWriter& operator=(const SensorLogWriter&) = delete;

  /// All samples must belong to one beacon, else files::IoError. The first IMU sample decides whether
  /// `imu.csv` has magnetometer columns. The first velocity creates `twist.csv`, the first truth `truth.csv`;
  /// NaN values become empty cells.
  void write(const ImuSample& sample);
  void write(const UltrasonicFix& fix);
  void write(const PairHeading& heading);
  void write(const TwistSample& twist);
  void write(const TruthSample& sample);
  void write(const Event& event);

  /// Passes all lines to the operating system.
  void flush();

  /// Fixes of a tag beside the tracked point or of a set pose, and headings of the body. A reader of the log
  /// takes them for those of the beacon and of a pair, because there are no columns for the difference.
  [[nodiscard]] std::uint64_t misread() const { return misread_; }

private:
  void admit(BeaconAddress address);
  void admit(ImuMeaning meaning);
  void write_imu_header(bool with_magnetometer);
  void flush_when_due();

  std::filesystem::path folder_;
  std::unique_ptr<csv::Writer> imu_;
  std::unique_ptr<csv::Writer> ultrasonic_;
  std::unique_ptr<csv::Writer> heading_;
  std::unique_ptr<csv::Writer> twist_;     ///< null until the first velocity
  std::unique_ptr<csv::Writer> truth_;     ///< null until the first truth
  LogMeta meta_;                           ///< metadata as written
  std::optional<bool> with_magnetometer_;  ///< empty until the first IMU sample
  std::uint64_t magnetic_fields_dropped_ = 0;
  std::uint64_t misread_ = 0;
  SteadyTime last_flush_;
};

}  // namespace sonopose::recording
