#pragma once
/// \file
/// The consumer of a run: records the poses, and the samples and statuses that explain them.

#include "faults/history.hpp"
#include "support/bus.hpp"

#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace sonopose::faults {

class Observer {
public:
  explicit Observer(const test::Bus& bus);
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  ~Observer();

  /// Discards the poses received or lost so far and older samples; keeps the statuses.
  void start();

  /// Adds the received data to `history`.
  void add_to(History& history) const;

  /// Calls `look` with the poses received so far and returns its result.
  template <class Look>
  auto with_poses(const Look& look) const {
    const std::lock_guard lock(mutex_);
    return look(poses_);
  }

  /// Waits until `done(reports)` is true for the reports received so far. Returns false after the timeout.
  template <class Done>
  bool wait_for_reports(const Done& done) const {
    std::unique_lock lock(mutex_);
    return came_.wait_for(lock, test::timeout, [&] { return done(reports_); });
  }

private:
  struct Writer {
    ProcessId process = 0;
    std::int32_t strength = 0;
  };

  template <class T>
  class Listener;

  void on(const dds::sub::DataReader<sonopose_FusedPose>& reader, const sonopose_FusedPose& pose,
          std::uint64_t writer, SteadyTime received);
  void on(const dds::sub::DataReader<sonopose_ImuSample>& reader, const sonopose_ImuSample& imu,
          std::uint64_t writer, SteadyTime received);
  void on(const dds::sub::DataReader<sonopose_FusionStatus>& reader, const sonopose_FusionStatus& status,
          std::uint64_t writer, SteadyTime received);
  Writer writer_of(const dds::core::Entity& reader, std::uint64_t writer);

  mutable std::mutex mutex_;
  mutable std::condition_variable came_;
  std::map<std::uint64_t, Writer> writers_;
  std::vector<Arrival> poses_;
  std::vector<Published> imu_;
  std::vector<FusionReport> reports_;
  std::vector<LivelinessLoss> losses_;
  std::uint64_t lost_ = 0;
  std::uint64_t rejected_ = 0;

  std::unique_ptr<Listener<sonopose_FusedPose>> pose_listener_;
  std::unique_ptr<Listener<sonopose_ImuSample>> imu_listener_;
  std::unique_ptr<Listener<sonopose_FusionStatus>> status_listener_;
  dds::domain::DomainParticipant participant_;
  dds::sub::DataReader<sonopose_FusedPose> pose_reader_ = dds::core::null;
  dds::sub::DataReader<sonopose_ImuSample> imu_reader_ = dds::core::null;
  dds::sub::DataReader<sonopose_FusionStatus> status_reader_ = dds::core::null;
};

}  // namespace sonopose::faults
