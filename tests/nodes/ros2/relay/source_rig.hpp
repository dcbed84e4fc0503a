#pragma once
// Drivers' topics as a source of a bridge. The drivers use a separate participant in this process.

#include "bridge/collecting_sink.hpp"
#include "ros2/relay/source.hpp"
#include "support/test_domain.hpp"
#include "support/wait_until.hpp"
#include <sonopose/ros2/messages/messages.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace sonopose::source_rig {

using ros2::Input;
using test::wait_until;
using Kind = Input::Kind;

constexpr TimeNs second_ns = 1'000'000'000;

/// A sink that is readable while the source runs.
class SharedSink final : public publication::SampleSink {
public:
  void on(const Event& event) override {
    const std::lock_guard lock(mutex_);
    kept_.on(event);
  }
  void on(const TruthSample& /*truth*/) override {}
  void on(const LineStatus& /*status*/) override {}
  void on(const BeaconStatus& status) override {
    const std::lock_guard lock(mutex_);
    kept_.on(status);
  }
  void tick() override {}

  [[nodiscard]] std::vector<ImuSample> imu_samples() const {
    const std::lock_guard lock(mutex_);
    return kept_.of_kind<ImuSample>();
  }
  [[nodiscard]] std::vector<UltrasonicFix> fixes() const {
    const std::lock_guard lock(mutex_);
    return kept_.of_kind<UltrasonicFix>();
  }
  [[nodiscard]] std::vector<BeaconStatus> statuses() const {
    const std::lock_guard lock(mutex_);
    return kept_.statuses;
  }
  [[nodiscard]] std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return kept_.events.size();
  }

private:
  mutable std::mutex mutex_;
  test::CollectingSink kept_;
};

/// A source with inputs, and the drivers' participant.
class Rig {
public:
  explicit Rig(const std::vector<Input>& inputs, const std::string& map_frame = "map")
      : environment_(::unsetenv("CYCLONEDDS_URI")),
        participant_(dds::ext::participant({.domain_id = domain_.id()})),
        drivers_(dds::ext::participant({.domain_id = domain_.id()})),
        node_(participant_, qos_, ros2::NameResolver({}), ros2::Distro::jazzy),
        source(
            ros2::relay::make_source(node_, inputs, {second_ns, second_ns}, map_frame,
                                     [this](logging::Level, const std::string& line) { add_line(line); })) {}
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  ~Rig() {
    stop_.request();
    if (running_.joinable()) running_.join();
  }

  void run() {
    running_ = std::thread([this] { source->run(sink, stop_); });
  }

  /// Makes a driver's writer and, if `matches`, waits for its reader.
  template <class T>
  dds::pub::DataWriter<T> driver(const std::string& topic, dds::Qos qos = {}, bool matches = true) {
    dds::pub::DataWriter<T> writer(dds::pub::Publisher(drivers_),
                                   dds::topic::Topic<T>(drivers_, ros2::name_in_dds(topic)), qos);
    if (matches) {
      REQUIRE(wait_until([&] {
        source->update_readers();
        return writer.publication_matched_status().current_count() > 0;
      }));
    }
    return writer;
  }

  [[nodiscard]] const dds::domain::DomainParticipant& drivers() const { return drivers_; }

  [[nodiscard]] bool has_logged(const std::string& text) const {
    const std::lock_guard lock(mutex_);
    return std::any_of(lines_.begin(), lines_.end(),
                       [&](const auto& line) { return line.find(text) != std::string::npos; });
  }
  [[nodiscard]] bool logs(const std::string& text) const {
    return wait_until([&] {
      source->log_changes();
      return has_logged(text);
    });
  }

  /// Number of logged lines about frames, and of those that were not logged.
  [[nodiscard]] std::pair<std::size_t, std::size_t> lines_and_missing() const {
    const std::lock_guard lock(mutex_);
    std::size_t logged = 0;
    std::size_t missing = 0;
    for (const std::string& line : lines_) {
      if (line.find("are in frame") != std::string::npos) ++logged;
      if (line.find("were not logged") != std::string::npos) missing += std::stoul(line);
    }
    return {logged, missing};
  }

  /// Returns true if the thread that forwards samples has logged a line.
  [[nodiscard]] bool has_logged_on_path() const {
    const std::lock_guard lock(mutex_);
    return line_on_running_thread_;
  }

private:
  void add_line(const std::string& line) {
    const std::lock_guard lock(mutex_);
    if (std::this_thread::get_id() == running_.get_id()) line_on_running_thread_ = true;
    lines_.push_back(line);
  }

  int environment_;  // first, because the environment may set CYCLONEDDS_URI
  test::TestDomain domain_;
  dds::qos::Provider qos_;
  dds::domain::DomainParticipant participant_;
  dds::domain::DomainParticipant drivers_;
  ros2::Node node_;
  process::StopSignal stop_;
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
  bool line_on_running_thread_ = false;
  std::thread running_;

public:
  SharedSink sink;
  std::unique_ptr<ros2::relay::Source> source;
};

inline ros2::Imu imu_at(TimeNs stamp_ns) {
  static const ros2::FrameNames frames;
  return ros2::raw_imu({}, stamp_ns, frames, {});
}

inline ros2::PointStamped fix_at(TimeNs stamp_ns, const ros2::FrameNames& frames) {
  return ros2::position_as_point({1, 2, 3}, stamp_ns, frames);
}

}  // namespace sonopose::source_rig
