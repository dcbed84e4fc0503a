#pragma once
/// \file
/// The recorder process: any set of the native topics into MCAP files.

#include "mcap/records.hpp"
#include "process/address_set.hpp"
#include "process/stop_signal.hpp"
#include "recorder/topic_tap.hpp"
#include "recorder/trigger.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recorder {

struct RecorderOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::filesystem::path file;
  std::vector<std::string> topics;   ///< by either name; empty: all
  std::vector<std::string> exclude;  ///< of these
  process::AddressSet beacons;
  mcap::Compression compression = mcap::Compression::lz4;
  std::uint64_t max_size_bytes = 0;       ///< of a file; 0: no limit
  double max_duration_s = 0;              ///< of a file; 0: no limit
  double keep_last_s = 0;                 ///< 0: everything is written at once
  std::size_t keep_bytes = 256UL << 20U;  ///< of memory for the last seconds
  std::string trigger_topic = {};         ///< by either name: a sample of it writes the last seconds
  bool trigger_on_status = false;         ///< a pose whose status turns bad writes them
  double duration_s = 0;                  ///< of the recording; 0: until stopped
  std::size_t queue_bytes = 64UL << 20U;  ///< of messages that wait for the disk
  bool ros2 = false;                      ///< topics of ROS 2 too, to FILE_ros2
  std::string version = {};               ///< of the program
  std::string command = {};               ///< that started it
};

/// What became of a recording.
struct RecorderReport {
  TapCounts counts;
  std::uint64_t recorded = 0;
  std::uint64_t bytes = 0;
  std::uint64_t lost_disk = 0;
  double duration_s = 0;
  std::vector<std::filesystem::path> files;
  std::map<std::string, std::uint64_t> received;      ///< by topic
  std::map<std::string, std::size_t> foreign_topics;  ///< with their writers
  std::size_t unnamed_topics = 0;                     ///< more of them than these
  std::exception_ptr failure;                         ///< that has ended it; null without one

  /// Whether all that was received is in the files.
  [[nodiscard]] bool is_complete() const { return counts.lost_queue == 0 && lost_disk == 0 && !failure; }
};

/// The topics that the options select. Throws std::invalid_argument for an unknown one, and if none is left.
std::vector<const dds::topics::SerializedTopic*> selected_topics(const RecorderOptions& options);

class Recorder {
public:
  /// Begins to record; leaves no file if it throws. Throws dds::Error, dds::qos::FileError, files::IoError,
  /// std::invalid_argument.
  explicit Recorder(const RecorderOptions& options);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  Recorder(Recorder&&) = delete;
  Recorder& operator=(Recorder&&) = delete;
  ~Recorder();

  /// Records until the stop, the end of the duration, or an error, which the report of `finish` has. Reports
  /// on the log.
  void run(const process::StopSignal& stop);

  /// From any thread: writes the last seconds.
  Trigger& trigger();

  /// Ends the recording; once.
  RecorderReport finish();

private:
  class Node;
  std::unique_ptr<Node> node_;
};

}  // namespace sonopose::recorder
