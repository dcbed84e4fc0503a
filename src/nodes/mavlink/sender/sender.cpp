#include "mavlink/sender/sender.hpp"

#include "autopilot/ardupilot.hpp"
#include "autopilot/external_vision_gate.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "mavlink/messages.hpp"
#include "mavlink/sender/heartbeat_tracker.hpp"
#include "mavlink/sender/unsent_report.hpp"
#include "presence/beacon_admission.hpp"
#include "process/service.hpp"
#include "process_log/log_publisher.hpp"
#include "threads/mutex.hpp"
#include "transport/serial_port.hpp"
#include "transport/udp_peer.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <thread>

namespace sonopose::mavlink::sender {
namespace {

using autopilot::NotSent;

constexpr TimeNs heartbeat_period_ns = 1'000'000'000;

std::unique_ptr<transport::ByteLink> make_link(const SenderOptions& options) {
  if (options.udp) return transport::open_udp_peer(*options.udp, options.local_port);
  try {
    return transport::open_serial_port(options.device, options.baud);
  } catch (const files::IoError& error) {
    throw std::invalid_argument(fmt::format("--device: {}", error.what()));
  }
}

/// The connection to the autopilot: reads on a thread of its own.
class AutopilotConnection {
public:
  explicit AutopilotConnection(const SenderOptions& options) : link_(make_link(options)) {
    thread_ = std::jthread([this] { read(); });
  }
  AutopilotConnection(const AutopilotConnection&) = delete;
  AutopilotConnection& operator=(const AutopilotConnection&) = delete;
  ~AutopilotConnection() { link_->stop(); }

  void send(const Frame& frame) {
    const threads::Lock lock(mutex_);
    link_->send(encode(frame, sequence_++));
  }

  struct Known {
    Identity own;
    std::optional<std::uint8_t> autopilot;
  };
  Known known() {
    const threads::Lock lock(mutex_);
    return {tracker_.own(), tracker_.kind(clocks::steady_now())};
  }

  [[nodiscard]] std::string name() const { return link_->name(); }
  [[nodiscard]] std::uint64_t unsent() const { return link_->unsent(); }
  [[nodiscard]] transport::SendFailures send_failures() const { return link_->send_failures(); }
  /// Throws what ended the reading.
  void check() {
    const threads::Lock lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
  }

private:
  void read() {
    constexpr std::chrono::milliseconds period{1000};
    std::array<std::uint8_t, 2048> buffer{};
    try {
      for (;;) {
        const auto result = link_->read(buffer, period);
        if (result.status == transport::ReadStatus::stopped) return;
        if (result.status == transport::ReadStatus::disconnected) {
          logging::warning(link_->name() + ": " + link_->last_error());
        }
        if (result.status == transport::ReadStatus::refused && !refused_) {
          logging::warning(link_->name() + ": ignoring datagrams from other machines");
          refused_ = true;
        }
        if (result.status == transport::ReadStatus::connected) logging::info(link_->name() + ": open");
        if (result.status != transport::ReadStatus::data) continue;
        const std::uint16_t port = result.sender.port;
        if (port != 0) decoder_.restart();  // each datagram has whole frames
        decoder_.feed({buffer.data(), result.size}, [this, port](const Frame& frame) { on(frame, port); });
      }
    } catch (...) {
      const threads::Lock lock(mutex_);
      failure_ = std::current_exception();
    }
  }

  void on(const Frame& frame, std::uint16_t port) {
    const TimeNs now_ns = clocks::host_now();
    Identity own;
    {
      const threads::Lock lock(mutex_);
      // Any program of the host can send something, but only the autopilot is to get poses and answers.
      if (tracker_.on(frame, port, clocks::steady_now())) link_->answer_last_sender();
      if (!tracker_.has_sent(frame, port)) return;
      own = tracker_.own();
    }
    if (const auto answer = timesync_answer(frame, own, now_ns)) send(*answer);
  }

  std::unique_ptr<transport::ByteLink> link_;
  Decoder decoder_;       ///< used by the reading thread only, like the next one
  bool refused_ = false;  ///< a datagram of another machine
  threads::Mutex mutex_;
  HeartbeatTracker tracker_ SONOPOSE_GUARDED_BY(mutex_);
  std::uint8_t sequence_ SONOPOSE_GUARDED_BY(mutex_) = 0;
  std::exception_ptr failure_ SONOPOSE_GUARDED_BY(mutex_);
  std::jthread thread_;  ///< last, so that it ends first
};

/// Decides on each pose and logs why there are none.
class Sender {
public:
  explicit Sender(const SenderOptions& options)
      : options_(options), connection_(options), rate_(options.rate_hz) {}

  void on(const FusedPose& pose) {
    posed_ = clocks::steady_now();
    const auto verdict = gate_.on(pose);
    const AutopilotConnection::Known known = connection_.known();
    const auto odometry = autopilot::external_odometry(pose, options_.mount, options_.north);
    address_ = pose.address;
    state_ = state_of(verdict, odometry, known);
    if (state_ == NotSent::none && !autopilot::is_of_clock(pose.time_ns, clocks::host_now())) {
      state_ = NotSent::other_clock;
    }
    if (state_ != NotSent::none || !stamp_.next(pose.time_ns) || !rate_.admits(pose.time_ns)) return;
    const PoseMessageFields fields{.time_ns = pose.time_ns,
                                   .in_ned = odometry.is_ned && known.autopilot == autopilot_px4,
                                   .reset_counter = gate_.take_reset_counter(),
                                   .quality_percent = verdict.quality_percent};
    connection_.send(options_.message == Message::odometry
                         ? mavlink::odometry(odometry, known.own, fields)
                         : vision_position_estimate(odometry, known.own, fields));
  }

  /// Sends a heartbeat and logs changes. Once a second.
  void tick() {
    connection_.check();
    const AutopilotConnection::Known known = connection_.known();
    connection_.send(heartbeat(known.own));
    if (!known.autopilot) {
      state_ = NotSent::no_autopilot;
    } else if (clocks::steady_now() - posed_ > autopilot::no_poses_after_ns) {
      state_ = NotSent::no_poses;
    }
    if (const auto news = unsent_report_.update(connection_.unsent(), connection_.send_failures())) {
      const std::string text = connection_.name() + ": " + news->text;
      if (news->is_warning) {
        logging::warning(text);
      } else {
        logging::info(text);
      }
    }
    if (state_ == logged_) return;
    logged_ = state_;
    if (state_ == NotSent::none) {
      logging::info(
          fmt::format("{}: sending the poses of beacon {} to the autopilot", connection_.name(), address_));
    } else {
      logging::warning(fmt::format("{}: not sending poses: {}", connection_.name(), text_of(*state_)));
    }
  }

private:
  [[nodiscard]] NotSent state_of(const autopilot::ExternalVisionGate::Verdict& verdict,
                                 const autopilot::ExternalOdometry& odometry,
                                 const AutopilotConnection::Known& known) const {
    if (!known.autopilot) return NotSent::no_autopilot;
    if (verdict.not_sent != NotSent::none) return verdict.not_sent;
    if (known.autopilot == autopilot_ardupilot) {
      return ardupilot_not_sent(odometry, options_.message == Message::odometry);
    }
    return !options_.north && !odometry.q_body_to_frame ? NotSent::yaw_unknown : NotSent::none;
  }

  const SenderOptions& options_;
  AutopilotConnection connection_;
  autopilot::ExternalVisionGate gate_;
  ros2::RateThinner rate_;
  ros2::RisingStamp stamp_{0};
  BeaconAddress address_ = 0;
  SteadyTime posed_ = clocks::steady_now();  ///< last pose, or the start
  std::optional<NotSent> state_;
  std::optional<NotSent> logged_;
  UnsentReport unsent_report_;
};

}  // namespace

void run(const SenderOptions& options, const process::StopSignal& stop) {
  namespace topics = dds::topics;
  const auto participant = dds::ext::participant(options.domain);
  const dds::qos::Provider qos(options.qos_file);
  const process_log::LogPublisher log(participant, qos);
  presence::BeaconAdmission admission(options.addresses, 1);
  auto reader =
      topics::make_reader(participant, qos, topics::pose, nullptr, topics::Delivery::live, &admission);
  const dds::sub::cond::ReadCondition has_data(reader, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_data;
  Sender sender(options);
  logging::info("serving");
  process::report_ready();
  SteadyTime due = clocks::steady_now();
  while (!stop.requested()) {
    dds::ext::wait(waitset, std::chrono::milliseconds(100));
    dds::ext::take_each(reader, [&](const sonopose_FusedPose& pose, const dds::sub::SampleInfo&) {
      sender.on(topics::from_idl(pose));
    });
    const SteadyTime now = clocks::steady_now();
    process::report_progress(now);
    if (now < due) continue;
    due = now + heartbeat_period_ns;
    sender.tick();
    if (const auto refused = admission.refusals()) logging::warning(*refused);
  }
}

}  // namespace sonopose::mavlink::sender
