#include "publication/topic_writers.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"

#include <algorithm>
#include <chrono>

namespace sonopose::publication {

TopicWriters::TopicWriters(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                           dds::topics::Delivery delivery, bool batch)
    : lossless_(delivery == dds::topics::Delivery::lossless),
      batch_(batch),
      imu_(make_writer(participant, qos, dds::topics::imu, &imu_listener_, delivery)),
      fix_(make_writer(participant, qos, dds::topics::fix, &fix_listener_, delivery)),
      heading_(make_writer(participant, qos, dds::topics::heading, &heading_listener_, delivery)),
      twist_(make_writer(participant, qos, dds::topics::twist, &twist_listener_, delivery)),
      truth_(make_writer(participant, qos, dds::topics::truth)),
      status_(make_writer(participant, qos, dds::topics::beacon_status)),
      line_(make_writer(participant, qos, dds::topics::line_status)),
      stationary_(make_writer(participant, qos, dds::topics::stationary_beacon)) {}

void TopicWriters::flush() {
  if (!batch_) return;
  dds::ext::flush(imu_);
  dds::ext::flush(fix_);
  dds::ext::flush(heading_);
  dds::ext::flush(twist_);
  dds::ext::flush(truth_);
  dds::ext::flush(status_);
  dds::ext::flush(line_);
  dds::ext::flush(stationary_);
}

/// Leaves out lossless streams: their writers would block here until their readers have received everything.
/// The end of the writers has the same effect.
void TopicWriters::unregister(BeaconAddress address) {
  const auto unregister_at = [address]<class T>(dds::pub::DataWriter<T>& writer) {
    T key{};
    key.address = address;
    dds::ext::try_unregister_instance(writer, key);
  };
  if (!lossless_) {
    unregister_at(imu_);
    unregister_at(fix_);
    unregister_at(heading_);
    unregister_at(twist_);
  }
  unregister_at(truth_);
  unregister_at(status_);
}

void TopicWriters::wait_for_readers() {
  constexpr TimeNs poll_period_ns = 20'000'000;
  constexpr TimeNs discovery_ns = 500'000'000;  // a reader of the same process is found soon
  constexpr TimeNs report_after_ns = 3'000'000'000;
  const SteadyTime began = clocks::steady_now();
  const auto is_matched = [](auto&... writers) {
    return ((writers.publication_matched_status().current_count() > 0) && ...);
  };
  SteadyTime matched = SteadyTime::max();
  const auto may_begin = [&] {
    if (!is_matched(imu_, fix_, heading_)) return false;
    matched = std::min(matched, clocks::steady_now());
    // A consumer need not read velocities.
    return is_matched(twist_) || clocks::steady_now() - matched > discovery_ns;
  };
  bool reported = false;
  while (!may_begin()) {
    if (stop_->wait_until(clocks::steady_now() + poll_period_ns)) return;
    if (!reported && clocks::steady_now() - began > report_after_ns) {
      logging::warning("waiting for a reader (is sonopose-fusion running?)");
      reported = true;
    }
  }
}

std::vector<std::string> TopicWriters::wait_until_read() {
  std::vector<std::string> unread;
  const auto wait = [&](auto& writer) {
    constexpr std::chrono::milliseconds step{200};
    constexpr int max_steps = 150;
    for (int i = 0; i < max_steps; ++i) {
      if (stopped() || dds::ext::wait_for_acknowledgments(writer, step)) return;
    }
    unread.push_back(writer.topic().name());
  };
  wait(imu_);
  wait(fix_);
  wait(heading_);
  wait(twist_);
  wait(truth_);
  return unread;
}

bool TopicWriters::has_reader() {
  return imu_.publication_matched_status().current_count() > 0;
}

}  // namespace sonopose::publication
