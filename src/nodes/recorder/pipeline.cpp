#include "recorder/pipeline.hpp"

#include "bus_log/instance_end.hpp"
#include "files/error.hpp"

#include <utility>

namespace sonopose::recorder {

Pipeline::Pipeline(Settings settings, Trigger& trigger, process::Wakeup& failed)
    : keeps_last_(settings.last.has_value()),
      queue_(settings.queue_bytes),
      series_(std::move(settings.series)),
      gaps_(series_.input_channel_ids()),
      ends_channel_id_(settings.ends_channel_id),
      writing_({.queue = queue_,
                .series = series_,
                .gaps = gaps_,
                .trigger = trigger,
                .counts = [this] { return counts(); },
                .last = std::move(settings.last),
                .failed = failed}) {}

void Pipeline::open() {
  if (!keeps_last_) series_.open();
}

void Pipeline::record(TapTopic topic, std::uint16_t channel_id, const MakeReader& make_reader) {
  const TapTarget target{.queue = queue_, .channel_id = channel_id, .ends_channel_id = ends_channel_id_};
  auto tap = std::make_unique<TopicTap>(std::move(topic), target);
  tap->open(make_reader(tap.get()));
  const threads::Lock lock(mutex_);
  taps_.push_back(std::move(tap));
}

TapCounts Pipeline::counts() const {
  const threads::Lock lock(mutex_);
  TapCounts sum;
  for (const auto& tap : taps_) sum += tap->counts();
  sum.events_missing = gaps_.missing();
  return sum;
}

std::map<std::string, std::uint64_t> Pipeline::received() const {
  const threads::Lock lock(mutex_);
  std::map<std::string, std::uint64_t> by_topic;
  std::uint64_t ends = 0;
  for (const auto& tap : taps_) {
    const std::uint64_t of_tap = tap->ends();  // first: an end is counted as received before
    by_topic[tap->name()] = tap->counts().received - of_tap;
    ends += of_tap;
  }
  if (ends > 0) by_topic[std::string(bus_log::instance_ends_topic)] = ends;
  return by_topic;
}

std::optional<BeaconAddress> Pipeline::only_left_out() const {
  const threads::Lock lock(mutex_);
  std::optional<BeaconAddress> left_out;
  for (const auto& tap : taps_) {
    if (tap->recorded_beacon() != all_beacons) return std::nullopt;
    if (tap->left_out_beacon() != all_beacons) left_out = tap->left_out_beacon();
  }
  return left_out;
}

std::uint64_t Pipeline::incompatible() const {
  const threads::Lock lock(mutex_);
  std::uint64_t sum = 0;
  for (const auto& tap : taps_) sum += tap->incompatible();
  return sum;
}

std::exception_ptr Pipeline::finish(const mcap::TextMap& more, std::exception_ptr failure) {
  std::vector<TopicTap*> taps;
  {
    const threads::Lock lock(mutex_);
    for (const auto& tap : taps_) taps.push_back(tap.get());
  }
  for (TopicTap* const tap : taps) tap->close();
  writing_.finish();
  if (writing_.failure()) failure = writing_.failure();
  std::string reason = "stopped";
  try {
    if (failure) std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    reason = std::string("error: ") + error.what();
  }
  try {
    series_.finish(reason, counts(), more);
  } catch (const files::IoError&) {
    if (!failure) failure = std::current_exception();
  }
  return failure;
}

}  // namespace sonopose::recorder
