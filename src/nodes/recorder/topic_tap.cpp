#include "recorder/topic_tap.hpp"

#include "clocks/clocks.hpp"
#include "process/endpoint_counters.hpp"
#include "recorder/raw_ends.hpp"

namespace sonopose::recorder {
namespace {

std::uint64_t file_time(std::int64_t time_ns) {
  return time_ns < 0 ? 0 : static_cast<std::uint64_t>(time_ns);
}

/// Publish time of a sample; the log time if its writer gave none.
std::uint64_t publish_time(const dds::sub::SampleInfo& info, std::int64_t log_time_ns) {
  const std::int64_t time_ns = dds::ext::source_time_ns(info);
  return file_time(time_ns > 0 ? time_ns : log_time_ns);
}

}  // namespace

void TopicTap::on_data_available(dds::SerializedReader& reader) noexcept {
  dds::ext::try_take_each(
      reader,
      [this](const dds::SerializedSample& sample, const dds::sub::SampleInfo& info) {
        on_sample(sample, info);
      },
      [this](const dds::SerializedSample& key, const dds::sub::SampleInfo& info) { on_end(key, info); });
}

void TopicTap::on_sample_lost(dds::SerializedReader& /*reader*/,
                              const dds::core::status::SampleLostStatus& status) noexcept {
  if (!topic_.is_exclusive) process::add(lost_dds_, status.total_count_change());
}

void TopicTap::on_requested_incompatible_qos(
    dds::SerializedReader& /*reader*/,
    const dds::core::status::RequestedIncompatibleQosStatus& status) noexcept {
  process::add(incompatible_, status.total_count_change());
}

bool TopicTap::accepts(std::span<const std::byte> sample) noexcept {
  if (!topic_.has_beacon) return true;
  const auto address = dds::topics::beacon_of(sample);
  if (!address || *address == all_beacons) return true;
  const bool is_recorded = topic_.beacons->contains(*address);
  (is_recorded ? recorded_beacon_ : left_out_beacon_) = *address;
  return is_recorded;
}

void TopicTap::on_sample(const dds::SerializedSample& sample, const dds::sub::SampleInfo& info) noexcept {
  const auto bytes = sample.bytes();
  if (!accepts(bytes)) return;
  const std::int64_t now_ns = clocks::host_now();
  // Lost samples are numbered too, so that the file shows the gap.
  add({.channel_id = target_.channel_id,
       .sequence = sequence_.fetch_add(1, std::memory_order_relaxed) + 1,
       .log_time_ns = file_time(now_ns),
       .publish_time_ns = publish_time(info, now_ns),
       .data = bytes});
  if (topic_.trigger != nullptr) topic_.trigger->on_sample(bytes);
}

void TopicTap::on_end(const dds::SerializedSample& key, const dds::sub::SampleInfo& info) noexcept {
  if (target_.ends_channel_id == 0 || !accepts(key.bytes())) return;
  const std::int64_t now_ns = clocks::host_now();
  add({.channel_id = target_.ends_channel_id,
       .sequence = 0,  // assigned later (raw_ends.hpp)
       .log_time_ns = file_time(now_ns),
       .publish_time_ns = publish_time(info, now_ns),
       .data = key.bytes()},
      raw_end_head(target_.channel_id, dds::ext::is_disposed(info)));
  ends_.fetch_add(1, std::memory_order_relaxed);
}

void TopicTap::add(const mcap::Message& message, std::span<const std::byte> head) noexcept {
  received_.fetch_add(1, std::memory_order_relaxed);
  if (!target_.queue.add(message, head)) lost_queue_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace sonopose::recorder
