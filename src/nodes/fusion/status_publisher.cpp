#include "fusion/status_publisher.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "process/random_id.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::fusion {

namespace topics = dds::topics;

StatusPublisher::StatusPublisher(const dds::domain::DomainParticipant& participant,
                                 const dds::qos::Provider& qos,
                                 threads::Guarded<BeaconEstimators>& estimators,
                                 const PosePublisher& pose_publisher, const Overload& overload,
                                 process::EndpointCounters& endpoints, transitions::TransitionLog& log)
    : fusion_id_(process::random_id()),
      estimators_(estimators),
      pose_publisher_(pose_publisher),
      overload_(overload),
      endpoints_(endpoints),
      log_(log),
      status_listener_(endpoints),
      status_writer_(topics::make_writer(participant, qos, topics::fusion_status, &status_listener_)),
      estimate_writer_(topics::make_writer(participant, qos, topics::estimate)) {}

void StatusPublisher::publish_all(std::uint64_t unwritten) {
  const auto addresses = estimators_.with([](auto& all) { return all.addresses(); });
  for (const BeaconAddress address : addresses) {
    publish_status(address, unwritten);
    publish_estimate(address);
    log_input_use(address);
    late_logs_.try_emplace(address);
  }
  log_losses(unwritten, false);
  log_overload();
}

/// Returns `read_from(estimator)` for the beacon's estimator; empty if it no longer has one.
auto StatusPublisher::read(BeaconAddress address, const auto& read_from) const {
  return estimators_.with([&](auto& all) {
    BeaconEstimator* const estimator = all.find(address);
    return estimator == nullptr ? std::nullopt : std::optional(read_from(*estimator));
  });
}

void StatusPublisher::publish_status(BeaconAddress address, std::uint64_t unwritten) {
  auto status = read(address, [](BeaconEstimator& estimator) { return estimator.status(); });
  if (!status) return;
  status->fusion_id = fusion_id_;
  status->time_ns = clocks::host_now();
  const PosePublisher::BeaconOutput output = pose_publisher_.output_of(address);
  status->role = output.role;
  status->strength = pose_publisher_.strength();
  status->overloaded = overload_.is_overloaded();
  status->poses_late = output.poses_late;
  status->poses_skipped = output.poses_skipped;
  status->poses_unwritten = unwritten + unwritten_;
  status->pose_deadlines_missed = endpoints_.offered_deadlines_missed;
  status->liveliness_lost = endpoints_.liveliness_lost;
  status->samples_lost = endpoints_.samples_lost;
  status->samples_rejected = endpoints_.samples_rejected;
  status->incompatible_qos = endpoints_.incompatible_qos;
  if (dds::ext::try_write(status_writer_, topics::to_idl(*status)) < 0) ++unwritten_;
}

void StatusPublisher::publish_estimate(BeaconAddress address) {
  auto estimate = read(address, [](BeaconEstimator& estimator) { return estimator.estimate(); });
  if (!estimate) return;
  estimate->fusion_id = fusion_id_;
  if (dds::ext::try_write(estimate_writer_, topics::to_idl(*estimate)) < 0) ++unwritten_;
}

void StatusPublisher::log_input_use(BeaconAddress address) {
  const auto texts = read(address, [](BeaconEstimator& estimator) {
    return std::array{estimator.fix_refusals(clocks::steady_now()), estimator.height_use(),
                      estimator.twist_use()};
  });
  if (!texts) return;
  for (const auto& text : *texts) {
    if (text) logging::warning(fmt::format("beacon {}: {}", address, *text));
  }
}

void StatusPublisher::log_gaps(bool waited_for_consumer) {
  if (waited_for_consumer) gaps_.start_over();
  std::vector<std::string> texts;
  estimators_.with([&](auto& all) {
    all.for_each([&](BeaconAddress address, const BeaconEstimator& estimator) {
      if (auto text = gaps_.on(address, estimator.gap(), clocks::steady_now())) {
        texts.push_back(*std::move(text));
      }
    });
  });
  for (const std::string& text : texts) logging::warning(text);
}

void StatusPublisher::log_losses(std::uint64_t unwritten, bool is_last) {
  const SteadyTime now = clocks::steady_now();
  const auto more = [&](logging::IncreaseLog& log, std::uint64_t count) {
    return is_last ? log.finish(count) : log.update(count, now);
  };
  if (const auto lost = more(unwritten_log_, unwritten + unwritten_)) {
    logging::warning(
        fmt::format("{} could not be written: a consumer is too slow", text::count_text(*lost, "sample")));
  }
  if (const auto readers = more(incompatible_log_, endpoints_.incompatible_qos)) {
    logging::warning(fmt::format("{} with incompatible QoS; run sonopose-doctor to list them",
                                 text::count_text(*readers, "reader or writer", "readers or writers")));
  }
  for (auto& [address, log] : late_logs_) {
    if (const auto late = more(log, pose_publisher_.output_of(address).poses_late)) {
      logging::warning(fmt::format("beacon {}: {} late: the IMU samples were old on arrival", address,
                                   text::count_text(*late, "pose was", "poses were")));
    }
  }
}

void StatusPublisher::log_overload() {
  const bool overloaded = overload_.is_overloaded();
  if (overloaded == overload_reported_) return;
  overload_reported_ = overloaded;
  log_.on({.address = all_beacons, .kind = transitions::Kind::overloaded, .begins = overloaded},
          clocks::steady_now());
}

void StatusPublisher::unregister(BeaconAddress address) noexcept {
  late_logs_.erase(address);
  sonopose_FusionStatus status{};
  status.address = address;
  status.fusion_id = fusion_id_;
  dds::ext::try_unregister_instance(status_writer_, status);
  sonopose_Estimate estimate{};
  estimate.address = address;
  estimate.fusion_id = fusion_id_;
  dds::ext::try_unregister_instance(estimate_writer_, estimate);
}

}  // namespace sonopose::fusion
