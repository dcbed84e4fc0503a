#pragma once
/// \file
/// Receives the events of all beacons: from a sample in a DDS reader to its pose at the publisher.

#include "fusion/backlog_thread.hpp"
#include "fusion/beacon_estimators.hpp"
#include "fusion/overload.hpp"
#include "fusion/pose_publisher.hpp"
#include "fusion/settings_server.hpp"
#include "presence/beacon_admission.hpp"
#include "process/endpoint_counters.hpp"
#include "process/stop_signal.hpp"
#include "threads/guarded.hpp"
#include "threads/mutex.hpp"
#include <sonopose/collation/pause_compensated_clock.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <atomic>
#include <thread>
#include <type_traits>

namespace sonopose::fusion {

/// Takes events, passes each to its beacon's estimator, and passes the results on. Live, Cyclone's receiving
/// thread does all of this; under load, a thread for the backlog. Lossless events have a thread of their own.
class EventReceiver {
public:
  /// Recipients of events. All must outlive the receiver.
  struct Targets {
    threads::Guarded<BeaconEstimators>& estimators;  ///< the lock guards each estimator too
    PosePublisher& publisher;
    SettingsServer& settings;
  };

  /// Starts receiving. `input_deadline_ns`: silence of an IMU that must be reported. Once `stopping` is set,
  /// it takes no further events.
  EventReceiver(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                dds::topics::Delivery delivery, presence::BeaconAdmission& admission, const Targets& targets,
                TimeNs input_deadline_ns, Overload& overload, process::EndpointCounters& endpoints,
                const std::atomic<bool>& stopping);
  EventReceiver(const EventReceiver&) = delete;
  EventReceiver& operator=(const EventReceiver&) = delete;
  ~EventReceiver();

  /// True while an event is processed.
  [[nodiscard]] bool is_working() const { return is_working_; }

  /// Latest time of the polling thread's next poll, while in the future. Receiving sets it while poses flow,
  /// so that this thread does not wake for nothing.
  [[nodiscard]] process::Alarm& poll_alarm() { return poll_alarm_; }

  /// Ends a deferral that no sample ends. Call it once a second.
  void update() noexcept;

private:
  /// Passes on the samples and status changes of one topic, on the receive thread.
  template <class T>
  class Listener final : public process::CountingReaderListener<T> {
  public:
    explicit Listener(EventReceiver& receiver)
        : process::CountingReaderListener<T>(receiver.endpoints_), receiver_(receiver) {}
    void on_data_available(dds::sub::DataReader<T>& reader) noexcept override { receiver_.on_data(reader); }
    void on_requested_deadline_missed(
        dds::sub::DataReader<T>& reader,
        const dds::core::status::RequestedDeadlineMissedStatus& status) noexcept override {
      receiver_.on_deadline_missed(reader, status);
    }
    void on_liveliness_changed(dds::sub::DataReader<T>& /*reader*/,
                               const dds::core::status::LivelinessChangedStatus& status) noexcept override {
      if (std::is_same_v<T, sonopose_ImuSample>) receiver_.on_bridge_liveliness(status);
    }
    void on_subscription_matched(
        dds::sub::DataReader<T>& /*reader*/,
        const dds::core::status::SubscriptionMatchedStatus& status) noexcept override {
      if (std::is_same_v<T, sonopose_ImuSample>) receiver_.on_bridge_matched(status);
    }

  private:
    EventReceiver& receiver_;
  };

  template <class T>
  void on_data(dds::sub::DataReader<T>& reader) noexcept;
  void on_data(dds::sub::DataReader<sonopose_ResetCommand>& reader) noexcept;
  template <class T>
  void on_deadline_missed(dds::sub::DataReader<T>& reader,
                          const dds::core::status::RequestedDeadlineMissedStatus& status) noexcept;
  void on_bridge_liveliness(const dds::core::status::LivelinessChangedStatus& status) noexcept;
  void on_bridge_matched(const dds::core::status::SubscriptionMatchedStatus& status) noexcept;
  template <class T>
  void take(dds::sub::DataReader<T>& reader, SteadyTime now) noexcept SONOPOSE_REQUIRES(taking_);
  void process(const Event& event, dds::core::InstanceHandle bridge, TimeNs in_ns, SteadyTime now) noexcept
      SONOPOSE_REQUIRES(taking_);
  void postpone_poll(SteadyTime now) noexcept SONOPOSE_REQUIRES(taking_);
  void take_backlog() noexcept;
  void on_caught_up() noexcept;
  void serve_lossless(const std::stop_token& stop);

  const TimeNs input_deadline_ns_;
  Targets targets_;
  process::EndpointCounters& endpoints_;
  const std::atomic<bool>& stopping_;
  std::atomic<bool> is_working_ = false;
  process::Alarm poll_alarm_;

  // Held by the thread that takes samples: Cyclone's receive thread, one of those below, or that of a
  // writer in this process.
  threads::Mutex taking_;
  Overload& overload_;  // its functions for one thread at a time: only while held
  collation::PauseCompensatedClock unpaused_clock_ SONOPOSE_GUARDED_BY(taking_);
  SteadyTime postponed_at_ SONOPOSE_GUARDED_BY(taking_);  // time of the last postponement

  Listener<sonopose_ImuSample> imu_listener_{*this};
  Listener<sonopose_UltrasonicFix> fix_listener_{*this};
  Listener<sonopose_PairHeading> heading_listener_{*this};
  Listener<sonopose_TwistSample> twist_listener_{*this};
  Listener<sonopose_ResetCommand> reset_listener_{*this};
  // Readers last: their listeners may be called before the constructor ends.
  dds::sub::DataReader<sonopose_ImuSample> imu_reader_ = dds::core::null;
  dds::sub::DataReader<sonopose_UltrasonicFix> fix_reader_ = dds::core::null;
  dds::sub::DataReader<sonopose_PairHeading> heading_reader_ = dds::core::null;
  dds::sub::DataReader<sonopose_TwistSample> twist_reader_ = dds::core::null;
  dds::sub::DataReader<sonopose_ResetCommand> reset_reader_ = dds::core::null;
  std::jthread lossless_thread_;
  BacklogThread backlog_thread_;
};

}  // namespace sonopose::fusion
