/// Drivers' topics as a bridge's source: the drivers are a participant of their own in this process.

#include "ros2/relay/source.hpp"

#include "bridge/collecting_sink.hpp"
#include "process/clocks.hpp"
#include "support/test_domain.hpp"
#include <sonopose/ros2/messages/messages.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace sonopose;
using ros2::Ros2Input;
using Kind = Ros2Input::Kind;

constexpr TimeNs second_ns = 1'000'000'000;

template <class Done>
bool wait_until(const Done& done) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

/// A sink that is looked into while the source runs.
class SharedSink final : public bridge::SampleSink {
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

/// Inputs, and the drivers' participant.
class Rig {
public:
  explicit Rig(const std::vector<Ros2Input>& inputs, const std::string& map_frame = "map")
      : environment_(::unsetenv("CYCLONEDDS_URI")),
        participant_(dds::make_participant({.domain_id = domain_.id()})),
        drivers_(dds::make_participant({.domain_id = domain_.id()})),
        node_(participant_, qos_, ros2::NameResolver({}), ros2::Distro::jazzy),
        source(ros2::make_ros2_source(node_, inputs, {second_ns, second_ns}, map_frame,
                                      [this](const std::string& line) { note(line); })) {}
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  ~Rig() {
    stop_.request();
    if (running_.joinable()) running_.join();
  }

  void run() {
    running_ = std::thread([this] { source->run(sink, stop_); });
  }

  /// A driver's writer. Where it matches, it has its reader when this returns.
  template <class T>
  dds::DataWriter<T> driver(const std::string& topic, dds::Qos qos = {}, bool matches = true) {
    dds::DataWriter<T> writer(drivers_, dds::Topic<T>(drivers_, ros2::name_in_dds(topic)), qos);
    if (matches) {
      REQUIRE(wait_until([&] { return writer.publication_matched_status().current_count > 0; }));
    }
    return writer;
  }

  [[nodiscard]] bool has_told(const std::string& text) const {
    const std::lock_guard lock(mutex_);
    return std::any_of(lines_.begin(), lines_.end(),
                       [&](const auto& line) { return line.find(text) != std::string::npos; });
  }
  [[nodiscard]] bool tells(const std::string& text) const {
    return wait_until([&] { return has_told(text); });
  }

private:
  void note(const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(line);
  }

  int environment_;  // first: whoever runs this may have a network of their own
  test::TestDomain domain_;
  dds::QosProvider qos_;
  dds::DomainParticipant participant_;
  dds::DomainParticipant drivers_;
  ros2::Node node_;
  process::StopSignal stop_;
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
  std::thread running_;

public:
  SharedSink sink;
  std::unique_ptr<ros2::Ros2Source> source;
};

ros2::Imu imu_at(TimeNs stamp_ns) {
  static const ros2::FrameNames frames;
  return ros2::raw_imu({}, stamp_ns, frames, {});
}

ros2::PointStamped fix_at(TimeNs stamp_ns, const ros2::FrameNames& frames) {
  return ros2::position_as_point({1, 2, 3}, stamp_ns, frames);
}

}  // namespace

SCENARIO("an input that is held up keeps what it can, and tells what it cannot") {
  GIVEN("a source that is not run while an IMU writes 1500 samples without a stamp") {
    constexpr std::size_t written = 1500;
    Rig rig({{Kind::imu, "/imu/data", 7}, {Kind::imu, "/other", 8}});
    auto imu = rig.driver<ros2::Imu>("/imu/data");
    for (std::size_t i = 0; i < written; ++i) imu.write(imu_at(0));
    WHEN("it is run") {
      rig.run();
      THEN("many are there, and the others are counted and told of, for this beacon alone") {
        REQUIRE(rig.tells("IMU samples from ROS 2 lost"));
        REQUIRE(wait_until([&] { return rig.sink.count() + rig.source->samples_lost(7) == written; }));
        CHECK(rig.sink.count() >= 64);
        CHECK(rig.source->samples_lost(7) > 0);
        CHECK(rig.source->samples_lost(8) == 0);
        CHECK(rig.source->samples_lost(9) == 0);
        CHECK(rig.has_told("beacon 7: " + std::to_string(rig.source->samples_lost(7)) + " IMU samples"));
      }
      THEN("each has a time of its own, though all were taken at once") {
        REQUIRE(wait_until([&] { return rig.sink.count() >= 64; }));
        const auto samples = rig.sink.imu_samples();
        CHECK(std::adjacent_find(samples.begin(), samples.end(), [](const auto& one, const auto& next) {
                return next.sensor_time_ns <= one.sensor_time_ns;
              }) == samples.end());
      }
      THEN("what comes then is taken") {
        REQUIRE(wait_until([&] { return rig.sink.count() > 0; }));
        const TimeNs stamp_ns = 1234 * second_ns;
        REQUIRE(wait_until([&] {
          imu.write(imu_at(stamp_ns));
          return rig.sink.imu_samples().back().sensor_time_ns == stamp_ns;
        }));
      }
    }
  }
}

SCENARIO("the clock's offset of an input is that of its IMU, at its quickest") {
  GIVEN("beacon 7, whose IMU's samples are 10 s old and more, and whose fixes are quicker") {
    Rig rig({{Kind::fix, "/tag", 7}, {Kind::imu, "/imu/data", 7}, {Kind::fix, "/tag", 8}});
    auto imu = rig.driver<ros2::Imu>("/imu/data");
    auto fixes = rig.driver<ros2::PointStamped>("/tag");
    imu.write(imu_at(process::host_now() - 10 * second_ns));
    imu.write(imu_at(process::host_now() - 500 * second_ns));
    fixes.write(fix_at(process::host_now() - second_ns, {}));
    rig.run();
    const auto offset_s = [&](BeaconAddress address) {
      double result = 0;
      REQUIRE(wait_until([&] {
        for (const BeaconStatus& status : rig.sink.statuses()) {
          if (status.address == address) result = status.clock_offset_s;
        }
        return result != 0;
      }));
      return result;
    };
    THEN("it is that of the quickest IMU sample, or of the fixes where there is no IMU") {
      REQUIRE(wait_until([&] { return rig.sink.count() == 4; }));
      CHECK(offset_s(7) >= 10);
      CHECK(offset_s(7) < 400);
      CHECK(offset_s(8) >= 1);
      CHECK(offset_s(8) < 10);
    }
  }
}

SCENARIO("inputs that bring nothing from the start are told of, each with its cause") {
  GIVEN("a refused IMU, one that is mute, and a position that nobody publishes") {
    Rig rig({{Kind::imu, "/refused", 7}, {Kind::imu, "/mute", 8}, {Kind::fix, "/tag", 7}});
    const auto exclusive = dds::Qos() << dds::policy::Ownership{dds::policy::OwnershipKind::exclusive};
    const auto refused = rig.driver<ros2::Imu>("/refused", exclusive, false);
    const auto mute = rig.driver<ros2::Imu>("/mute");
    rig.run();
    THEN("all three are told") {
      CHECK(rig.tells("beacon 7: no IMU samples from ROS 2 yet: the QoS of 1 publisher of /refused"));
      CHECK(rig.tells("beacon 8: no IMU samples from ROS 2 yet: /mute has 1 publisher, but nothing"));
      CHECK(rig.tells("beacon 7: no fixes from ROS 2 yet: nobody publishes"));
    }
  }
}

SCENARIO("fixes in a foreign frame are taken, but not without a word") {
  GIVEN("beacons whose map is named after them, and fixes in the frame of the first") {
    Rig rig({{Kind::fix, "/tag", 7}, {Kind::fix, "/tag", 8}}, "map_{address}");
    auto fixes = rig.driver<ros2::PointStamped>("/tag");
    ros2::FrameNames frames;
    frames.map = "map_7";
    fixes.write(fix_at(process::host_now(), frames));
    rig.run();
    THEN("the second alone is told of, and both are taken") {
      REQUIRE(wait_until([&] { return rig.sink.count() == 2; }));
      CHECK(rig.tells("beacon 8: fixes on /tag are in frame 'map_7': they are taken as in 'map_8'"));
      CHECK_FALSE(rig.has_told("beacon 7: fixes on /tag are in frame"));
    }
  }
}

SCENARIO("a source mixes no two sensors") {
  GIVEN("two topics of IMU samples for one beacon") {
    THEN("it is refused") {
      CHECK_THROWS_AS(Rig({{Kind::imu, "/a", 7}, {Kind::imu, "/b", 7}}), std::invalid_argument);
    }
  }
}
