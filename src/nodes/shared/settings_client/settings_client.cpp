#include "settings_client/settings_client.hpp"

#include "clocks/clocks.hpp"
#include "process/random_id.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace sonopose::settings_client {
namespace {

namespace topics = dds::topics;

/// Id that is unique among clients, and never 0.
std::uint64_t new_request_id() {
  return process::random_id() | 1;
}

SteadyTime deadline_after(double timeout_s) {
  return clocks::steady_now() + to_ns(timeout_s);
}

/// Calls `on_sample(const T&, const SampleInfo&)` for each sample, until `done()` or the deadline. Returns
/// `done()`, which is polled every 20 ms.
template <class T, class OnSample, class Done>
bool take_until(dds::sub::DataReader<T>& reader, SteadyTime deadline, const OnSample& on_sample,
                const Done& done) {
  const dds::sub::cond::ReadCondition has_data(reader, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_data;
  while (true) {
    dds::ext::take_each(reader, on_sample);
    if (done()) return true;
    if (clocks::steady_now() >= deadline) return false;
    dds::ext::wait(waitset, std::chrono::milliseconds(20));
  }
}

/// Detects the end of the burst of historical samples that a new reader receives: no sample for 0.3 s.
class BurstDetector {
public:
  void on_sample() { last_ = clocks::steady_now(); }
  [[nodiscard]] bool has_ended() const {
    constexpr TimeNs quiet_ns = 300'000'000;
    return last_ != SteadyTime{} && clocks::steady_now() - last_ > quiet_ns;
  }

private:
  SteadyTime last_;
};

/// A reader that keeps the samples of every fusion, not only the latest one of a beacon.
dds::sub::DataReader<sonopose_EffectiveSettings> changed_settings_reader(
    const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos) {
  const auto no_filter = static_cast<topics::AddressFilter*>(nullptr);
  dds::Qos changes;
  changes << dds::policy::History::KeepAll();
  return topics::make_reader(participant, qos, topics::changed_settings, nullptr, topics::Delivery::live,
                             no_filter, dds::core::status::StatusMask::all(), changes);
}

/// Reset counters by beacon and fusion (its status writer).
using ResetCounters = std::map<std::pair<BeaconAddress, std::uint64_t>, std::uint32_t>;

}  // namespace

SettingsClient::SettingsClient(const dds::DomainOptions& domain,
                               const std::optional<std::filesystem::path>& qos_file)
    : SettingsClient(dds::ext::participant(domain), qos_file) {}

SettingsClient::SettingsClient(dds::domain::DomainParticipant participant,
                               const std::optional<std::filesystem::path>& qos_file)
    : qos_(qos_file), participant_(std::move(participant)) {}

std::vector<EffectiveSettings> SettingsClient::effective(BeaconAddress address, double timeout_s) {
  auto reader = dds::topics::make_reader(participant_, qos_, topics::settings);
  std::map<BeaconAddress, EffectiveSettings> found;
  BurstDetector burst;
  take_until(
      reader, deadline_after(timeout_s),
      [&](const sonopose_EffectiveSettings& sample, const dds::sub::SampleInfo&) {
        burst.on_sample();
        found[sample.address] = dds::topics::from_idl(sample);
      },
      [&] { return burst.has_ended() || (address != all_beacons && found.contains(address)); });
  std::vector<EffectiveSettings> settings;
  const auto move_out = [&](BeaconAddress key) {
    if (auto entry = found.extract(key)) settings.push_back(std::move(entry.mapped()));
  };
  move_out(address);  // all_beacons comes first
  if (settings.empty() && address != all_beacons) move_out(all_beacons);
  if (address != all_beacons) return settings;
  for (auto& entry : found) settings.push_back(std::move(entry.second));
  return settings;
}

std::vector<EffectiveSettings> SettingsClient::changed(double timeout_s) {
  constexpr double discovery_s = 1.0;  // enough to find a second fusion
  const SteadyTime discovered = deadline_after(std::min(discovery_s, 0.5 * timeout_s));
  auto reader = changed_settings_reader(participant_, qos_);
  std::map<std::pair<BeaconAddress, std::uint64_t>, EffectiveSettings> found;  // by beacon and fusion
  std::size_t complete = 0;  // fusions whose samples have all arrived: all_beacons is the last one
  BurstDetector burst;
  const bool done = take_until(
      reader, deadline_after(timeout_s),
      [&](const sonopose_EffectiveSettings& sample, const dds::sub::SampleInfo& info) {
        burst.on_sample();
        const bool is_first = found
                                  .insert_or_assign({sample.address, info.publication_handle().c_value()},
                                                    dds::topics::from_idl(sample))
                                  .second;
        if (is_first && sample.address == all_beacons) ++complete;
      },
      [&] {
        const auto fusions = static_cast<std::size_t>(reader.subscription_matched_status().current_count());
        const bool waited = burst.has_ended() && clocks::steady_now() >= discovered;
        return waited && complete >= std::max<std::size_t>(1, fusions);
      });
  if (!done) return {};
  std::vector<EffectiveSettings> settings;
  for (auto& [beacon_and_fusion, values] : found) {
    if (settings.empty() || settings.back().address != values.address) {
      settings.push_back(std::move(values));
    } else if (settings.back().values != values.values) {
      throw std::runtime_error(
          "the fusions in this domain have different settings, of which a file can have one: stop all but "
          "one");
    }
  }
  return settings;
}

std::optional<SettingsReply> SettingsClient::change(SettingsRequest request, double timeout_s,
                                                    const Stopped& stopped) {
  constexpr TimeNs resend_period_ns = 250'000'000;
  request.request_id = new_request_id();
  auto reader = dds::topics::make_reader(participant_, qos_, topics::settings_reply);
  auto writer = dds::topics::make_writer(participant_, qos_, topics::settings_request);
  const auto sample = dds::topics::to_idl(request);  // throws for too long a text, before anything is sent
  std::optional<SettingsReply> received;
  SteadyTime next_send;
  take_until(
      reader, deadline_after(timeout_s),
      [&](const sonopose_SettingsReply& reply, const dds::sub::SampleInfo&) {
        const bool is_ours = reply.address == request.address && reply.request_id == request.request_id;
        if (is_ours && !received) received = dds::topics::from_idl(reply);
      },
      [&] {
        // The fusion may discover the reader of replies after this match, and its first reply may be lost. It
        // answers a repeated request again.
        const bool matched = writer.publication_matched_status().current_count() > 0;
        if (!received && matched && clocks::steady_now() >= next_send) {
          writer.write(sample.sample());
          next_send = clocks::steady_now() + resend_period_ns;
        }
        return received.has_value() || stopped();
      });
  return received;
}

void SettingsClient::observe(BeaconAddress address,
                             const std::function<void(const EffectiveSettings&)>& on_settings,
                             double duration_s, const process::StopSignal& stop) {
  auto reader = dds::topics::make_reader(participant_, qos_, topics::settings);
  take_until(
      reader, duration_s > 0 ? deadline_after(duration_s) : SteadyTime::max(),
      [&](const sonopose_EffectiveSettings& sample, const dds::sub::SampleInfo&) {
        if (address == all_beacons || sample.address == address) on_settings(dds::topics::from_idl(sample));
      },
      [&] { return stop.requested(); });
}

std::vector<BeaconAddress> SettingsClient::reset(BeaconAddress address, double timeout_s,
                                                 const Stopped& stopped) {
  const SteadyTime deadline = deadline_after(timeout_s);
  auto reader = dds::topics::make_reader(participant_, qos_, topics::fusion_status);
  auto writer = dds::topics::make_writer(participant_, qos_, topics::reset);
  ResetCounters before;
  std::set<BeaconAddress> done;
  BurstDetector burst;
  bool sent = false;
  const auto on_status = [&](const sonopose_FusionStatus& status, const dds::sub::SampleInfo& info) {
    if (address != all_beacons && status.address != address) return;
    const auto [known, first] =
        before.try_emplace({status.address, info.publication_handle().c_value()}, status.reset_counter);
    if (!sent) {
      known->second = status.reset_counter;
      if (first) burst.on_sample();
    } else if (status.reset_counter > known->second) {
      done.insert(status.address);
    }
  };
  const bool ready = take_until(reader, deadline, on_status, [&] {
    return stopped() || (burst.has_ended() && writer.publication_matched_status().current_count() > 0);
  });
  if (!ready || stopped()) return {};
  std::set<BeaconAddress> beacons;
  for (const auto& entry : before) beacons.insert(entry.first.first);
  sent = true;
  writer.write({.address = address, .request_id = new_request_id()});
  const auto all_done = [&] {
    return std::includes(done.begin(), done.end(), beacons.begin(), beacons.end());
  };
  take_until(reader, deadline, on_status, [&] { return stopped() || all_done(); });
  if (!all_done()) return {};
  return {beacons.begin(), beacons.end()};
}

}  // namespace sonopose::settings_client
