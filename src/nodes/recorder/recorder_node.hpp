#pragma once
/// \file
/// The recorder process: writes any set of native topics to MCAP files.

#include "mcap/records.hpp"
#include "presence/address_set.hpp"
#include "process/stop_signal.hpp"
#include "recorder/foreign_topics.hpp"
#include "recorder/pipeline.hpp"
#include "recorder/ros2_topics.hpp"
#include "recorder/topic_tap.hpp"
#include "recorder/trigger.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recorder {

struct RecorderOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::filesystem::path file;
  std::vector<std::string> topics;   ///< short or full names; empty: all
  std::vector<std::string> exclude;  ///< excluded topics
  presence::AddressSet beacons;
  mcap::Compression compression = mcap::Compression::lz4;
  std::uint64_t max_size_bytes = 0;       ///< limit of a file; 0: none
  double max_duration_s = 0;              ///< limit of a file; 0: none
  std::size_t max_files = 0;              ///< limit, beyond which the oldest files are removed; 0: none
  std::uint64_t max_total_bytes = 0;      ///< limit of all files, of which the oldest are removed; 0: none
  bool includes_earlier = false;          ///< these two limits include the files of earlier recordings
  bool is_named_by_time = false;          ///< `file` has the time of the start in its name
  double keep_last_s = 0;                 ///< length of the memory; 0: write everything immediately
  std::size_t keep_bytes = 256UL << 20U;  ///< memory for the last seconds
  std::string trigger_topic = {};         ///< short or full name; any sample of it writes the last seconds
  bool trigger_on_status = false;         ///< a pose whose status turns bad writes the last seconds
  double duration_s = 0;                  ///< length of the recording; 0: until stopped
  std::size_t queue_bytes = 64UL << 20U;  ///< memory for messages that wait for the disk
  bool ros2 = false;                      ///< also records topics of ROS 2, to FILE_ros2
  std::string version = {};               ///< version of the program
  std::string command = {};               ///< command line of the program
};

/// Result of a recording.
struct RecorderReport {
  TapCounts counts;
  std::uint64_t recorded = 0;
  std::uint64_t bytes = 0;
  std::uint64_t lost_disk = 0;
  double duration_s = 0;
  std::vector<std::filesystem::path> files;
  std::size_t removed_files = 0;
  std::map<std::string, std::uint64_t> received;      ///< by topic
  std::map<std::string, std::size_t> foreign_topics;  ///< number of writers by topic
  std::size_t unnamed_topics = 0;                     ///< number of further foreign topics
  std::optional<BeaconAddress> only_left_out;         ///< a beacon outside of the choice, if none of it came
  std::exception_ptr failure;                         ///< cause of the end; null without one

  /// True if everything received is in the files.
  [[nodiscard]] bool is_complete() const { return counts.lost_queue == 0 && lost_disk == 0 && !failure; }
};

/// The topics that the options select. Throws std::invalid_argument for an unknown one, and if none is left.
std::vector<const dds::topics::SerializedTopic*> selected_topics(const RecorderOptions& options);

/// Records the selected topics from its construction on.
class Recorder {
public:
  /// Starts recording; leaves no file if it throws. Throws dds::core::Exception, dds::qos::FileError,
  /// files::IoError, std::invalid_argument.
  explicit Recorder(const RecorderOptions& options);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() = default;

  /// Records until the stop, the end of the duration, or an error, which the report of `finish` contains.
  /// Reports to the log.
  void run(const process::StopSignal& stop);

  /// Writes the last seconds when fired, from any thread.
  Trigger& trigger() { return trigger_; }

  /// Ends the recording. Call it once.
  RecorderReport finish();

private:
  [[nodiscard]] TapCounts counts() const;
  [[nodiscard]] bool has_failed() const;
  void report_begin() const;
  void report_news();
  void report_rate();
  void report_foreign(std::vector<dds::FoundEndpoint> writers);
  [[nodiscard]] mcap::TextMap foreign_text() const;
  TopicTrigger* trigger_of(const dds::topics::SerializedTopic& topic);

  RecorderOptions options_;
  dds::qos::Provider qos_;
  std::vector<const dds::topics::SerializedTopic*> selected_;
  process::Wakeup news_;  ///< the disk has failed, or a writer has appeared
  dds::domain::DomainParticipant participant_;
  dds::Discovery discovery_;
  ForeignTopics foreign_;
  Trigger trigger_;
  AnySampleTrigger any_sample_{trigger_};
  BadStatusTrigger bad_status_{trigger_};
  Pipeline native_;
  std::optional<Pipeline> ros2_;
  std::optional<Ros2Topics> ros2_topics_;
  SteadyTime began_;
  TapCounts reported_;
  std::uint64_t incompatible_reported_ = 0;
  bool is_rate_reported_ = false;
  std::exception_ptr failure_;  ///< error other than of the disk; null without one
};

}  // namespace sonopose::recorder
