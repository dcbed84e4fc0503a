#include "fusion/outcome_writer.hpp"

#include "clocks/clocks.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <variant>

namespace sonopose::fusion {

OutcomeWriter::OutcomeWriter(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                             dds::topics::Delivery delivery, PoseOutput& output, Overload& overload,
                             process::EndpointCounters& endpoints, const std::atomic<bool>& stopping)
    : lossless_(delivery == dds::topics::Delivery::lossless),
      output_(output),
      overload_(overload),
      stopping_(stopping),
      report_listener_(endpoints),
      report_writer_(
          dds::topics::make_writer(participant, qos, dds::topics::report, &report_listener_, delivery)) {}

void OutcomeWriter::write(EventOutcome& outcome, BeaconAddress address, TimeNs in_ns) noexcept {
  if (outcome.settings_changed) output_.set_period(address, outcome.prediction_period_ns);
  if (auto* pose = std::get_if<FusedPose>(&outcome.result)) {
    pose->fusion_in_time_ns = in_ns;
    if (!overload_.is_overloaded()) {
      write(*pose);
    } else {
      if (newest_ && newest_->address != address) write_newest();
      if (newest_) output_.count_skipped(address);
      newest_ = *pose;
    }
  } else if (const auto* report = std::get_if<FixReport>(&outcome.result)) {
    const auto sample = dds::topics::to_idl(*report);
    write_until_accepted([&] { return report_writer_.try_write(sample); });
  }
}

/// Writes a pose. Lateness is judged at this moment: the process may have been stopped since it took the
/// sample.
void OutcomeWriter::write(FusedPose& pose) noexcept {
  const SteadyTime now = clocks::steady_now();
  const PoseOutput::Route route = output_.route(pose, now);
  overload_.on_pose(route.late_ns, now);
  if (route.writer != nullptr) write_until_accepted([&] { return output_.write(*route.writer, pose); });
}

/// Writes the newest pose of a beacon in the backlog, unless another was written shortly before.
void OutcomeWriter::write_newest() noexcept {
  if (!newest_) return;
  FusedPose& pose = *newest_;
  if (output_.is_due(pose, overload_.pose_spacing_ns())) {
    pose.status |= status_overloaded;
    write(pose);
  } else {
    output_.count_skipped(pose.address);
  }
  newest_.reset();
}

void OutcomeWriter::unregister(BeaconAddress address) noexcept {
  sonopose_FixReport key{};
  key.address = address;
  report_writer_.try_unregister_instance(key);
}

/// Writes; in lossless mode repeats `attempt` until a slow consumer has space.
void OutcomeWriter::write_until_accepted(const auto& attempt) noexcept {
  if (lossless_ && stopping_) return;  // each attempt may wait for a consumer
  const auto give_up = [this] {
    if (!lossless_ || stopping_) return true;
    waited_ = true;
    return false;
  };
  if (dds::retry_unless(give_up, attempt) < 0) unwritten_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace sonopose::fusion
