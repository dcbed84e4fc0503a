#include "observation/bus/bus_watch.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "observation/bus/endpoint_log.hpp"
#include "observation/bus/line_observer.hpp"
#include "observation/bus/pose_writer_log.hpp"
#include "observation/bus/subscriptions.hpp"
#include "process/free_memory.hpp"
#include <sonopose/dds/topics/topics.hpp>

#include <fmt/format.h>

#include <utility>

namespace sonopose::observation::bus {
namespace {

namespace topics = dds::topics;

/// Logs silences immediately: a vehicle controlled with these poses is affected too.
void log_silences(const std::vector<PoseSilence>& changes) {
  for (const auto& change : changes) {
    if (change.silent) {
      logging::warning(fmt::format("beacon {}: no pose for {:.3f} s", change.address, change.lasted_s));
    } else {
      logging::info(
          fmt::format("beacon {}: poses arrive again, after {:.3f} s", change.address, change.lasted_s));
    }
  }
}

}  // namespace

class BusWatch::Impl {
public:
  Impl(const BusWatchOptions& options, SampleHook* hook)
      : qos_(options.qos_file),
        participant_(dds::ext::participant(options.domain)),
        observers_(dds::deadline_of(qos_.datareader_qos(topics::pose.profile)).count()),
        admission_({}, options.max_beacons),
        subscriptions_({participant_, qos_, observers_, admission_, endpoints_, hook}, options.has_reports),
        lines_(participant_, qos_),
        pose_writers_(participant_) {}

  std::vector<PoseSilence> poll() {
    constexpr TimeNs pose_writers_period_ns = 500'000'000;
    subscriptions_.take();
    std::vector<PoseSilence> silences = observers_.silence_changes();
    log_silences(silences);
    const SteadyTime now = clocks::steady_now();
    if (now >= next_pose_writers_) {
      pose_writers_.log(observers_.served());
      next_pose_writers_ = now + pose_writers_period_ns;
    }
    return silences;
  }

  BusSnapshot take_snapshot() {
    BusSnapshot snapshot;
    const SteadyTime now = clocks::steady_now();
    snapshot.gone = observers_.remove_gone(now, clocks::host_now());
    for (const BeaconView& view : snapshot.gone) {
      admission_.forget(view.address);  // others may take its place
      logging::info(fmt::format("beacon {}: gone", view.address));
      free_memory_.on_freed();
    }
    free_memory_.give_back(now);
    endpoint_log_.log(endpoints_);
    for (const auto& text : {admission_.refusals(), subscriptions_.refusals(), lines_.refusals()}) {
      if (text) logging::warning(*text);
    }
    logging::report_left_out();
    lines_.take();
    snapshot.warnings = lines_.warnings();
    snapshot.warnings.insert(snapshot.warnings.end(), pose_writers_.warnings().begin(),
                             pose_writers_.warnings().end());
    if (auto text = admission_.warning()) snapshot.warnings.push_back(*std::move(text));
    snapshot.beacons = observers_.take_windows(clocks::host_now());
    return snapshot;
  }

  std::vector<BeaconView> summaries() {
    subscriptions_.take();
    return observers_.summaries(clocks::host_now());
  }

  [[nodiscard]] const dds::domain::DomainParticipant& participant() const { return participant_; }
  [[nodiscard]] const dds::qos::Provider& qos() const { return qos_; }

private:
  dds::qos::Provider qos_;
  dds::domain::DomainParticipant participant_;
  BeaconObservers observers_;
  presence::BeaconAdmission admission_;
  process::EndpointCounters endpoints_;
  EndpointLog endpoint_log_;
  Subscriptions subscriptions_;
  LineObserver lines_;
  PoseWriterLog pose_writers_;
  process::FreeMemory free_memory_;
  SteadyTime next_pose_writers_;
};

BusWatch::BusWatch(const BusWatchOptions& options, SampleHook* hook)
    : impl_(std::make_unique<Impl>(options, hook)) {}
BusWatch::~BusWatch() = default;

const dds::domain::DomainParticipant& BusWatch::participant() const {
  return impl_->participant();
}

const dds::qos::Provider& BusWatch::qos() const {
  return impl_->qos();
}

std::vector<PoseSilence> BusWatch::poll() {
  return impl_->poll();
}

BusSnapshot BusWatch::take_snapshot() {
  return impl_->take_snapshot();
}

std::vector<BeaconView> BusWatch::summaries() {
  return impl_->summaries();
}

}  // namespace sonopose::observation::bus
