#include "fusion/settings_server.hpp"

#include "clocks/clocks.hpp"
#include "config/beacon_settings.hpp"
#include "logging/log.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::fusion {

namespace topics = dds::topics;

SettingsServer::SettingsServer(const dds::domain::DomainParticipant& participant,
                               const dds::qos::Provider& qos, threads::Guarded<BeaconEstimators>& estimators,
                               presence::AddressSet addresses)
    : estimators_(estimators),
      addresses_(std::move(addresses)),
      requests_(estimators),
      settings_writer_(topics::make_writer(participant, qos, topics::settings)),
      changed_writer_(topics::make_writer(participant, qos, topics::changed_settings)),
      reply_writer_(topics::make_writer(participant, qos, topics::settings_reply)),
      request_reader_(topics::make_reader(participant, qos, topics::settings_request)) {
  publish(estimators_.with([](auto& all) { return all.settings_for_all(); }));
  publish_changed(all_beacons);
  thread_ = std::thread([this] { serve(); });
}

SettingsServer::~SettingsServer() {
  stopping_ = true;
  wake_.trigger_value(true);
  thread_.join();
  publish_changes();
  unregister(all_beacons);
}

void SettingsServer::unregister(BeaconAddress address) noexcept {
  sonopose_EffectiveSettings settings{};
  settings.address = address;
  dds::ext::try_unregister_instance(settings_writer_, settings);
}

void SettingsServer::replace(config::FusionConfig config) {
  replacement_.with([&](auto& replacement) { replacement = std::move(config); });
  wake_.trigger_value(true);
}

/// Replaces the settings on the thread of the requests, which would otherwise write back their copies.
void SettingsServer::replace_requested() {
  const auto config = replacement_.with([](auto& each) { return std::exchange(each, std::nullopt); });
  if (!config) return;
  estimators_.with([&](auto& all) {  // under one lock: a beacon that appears meanwhile gets the new ones too
    std::vector<BeaconAddress> addresses = all.scheduled();
    for (const BeaconAddress address : config->beacons()) addresses.push_back(address);
    addresses.push_back(all_beacons);
    for (const BeaconAddress address : addresses) {
      SettingsTimeline timeline(config->beacon(address));
      timeline.add(0, SettingsTimeline::Scope::for_all, {});  // a change, which the next event takes
      all.exchange_timeline(address, timeline);
    }
  });
  publish(estimators_.with([](auto& all) { return all.settings_for_all(); }));
  publish_changed(all_beacons);
  log_.write(logging::Level::info, "settings read again", clocks::steady_now());
}

void SettingsServer::serve() {
  const dds::sub::cond::ReadCondition has_requests(request_reader_, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_requests;
  waitset += wake_;
  while (!stopping_) {
    constexpr std::chrono::seconds report_period{1};
    dds::ext::wait(waitset,
                   log_.has_pending() ? std::chrono::nanoseconds(report_period) : dds::ext::infinite);
    log_.update(clocks::steady_now());
    wake_.trigger_value(false);
    replace_requested();
    publish_changes();
    dds::ext::try_take_each(
        request_reader_, [this](const sonopose_SettingsRequest& request, const dds::sub::SampleInfo&) {
          if (stopping_) return;
          const SteadyTime begin = clocks::steady_now();
          try_answer(request);
          std::this_thread::sleep_for(std::chrono::nanoseconds(clocks::steady_now() - begin));
        });
  }
  log_.finish();
}

/// Answers a request and logs an error: one request must not end the poses of all beacons. Its sender repeats
/// it.
void SettingsServer::try_answer(const sonopose_SettingsRequest& request) {
  try {
    answer(request);
  } catch (const std::exception& error) {
    log_.write(logging::Level::error, fmt::format("a request for settings has no reply: {}", error.what()),
               clocks::steady_now());
  }
}

void SettingsServer::answer(const sonopose_SettingsRequest& request) {
  if (request.address != all_beacons && !addresses_.contains(request.address)) return;
  const SettingsRequest asked = topics::from_idl(request);
  const SettingsReply reply = requests_.answer(asked);
  log(asked, reply);
  if (reply.accepted) {  // before the reply, so that the client reads them
    if (reply.address == all_beacons) {
      publish(estimators_.with([](auto& all) { return all.settings_for_all(); }));
    }
    publish_changed(reply.address);
  }
  const auto sample = topics::to_idl(reply);
  write([&] { return dds::ext::try_write(reply_writer_, sample); });
}

/// Logs a request, rate-limited and bounded: any program can send requests.
void SettingsServer::log(const SettingsRequest& request, const SettingsReply& reply) {
  if (request.request_id != 0 && std::exchange(last_logged_id_, request.request_id) == request.request_id) {
    return;
  }
  std::string text = request.address == all_beacons ? "settings of all beacons"
                                                    : fmt::format("settings of beacon {}", request.address);
  text += reply.accepted ? " changed" : " refused";
  const char* separator = ": ";
  for (const SettingAssignment& assignment : request.assignments) {
    text += fmt::format("{}{} = {}", std::exchange(separator, ", "), assignment.key, assignment.value);
  }
  if (!reply.reason.empty()) text += "; " + reply.reason;
  constexpr std::size_t max_bytes = 1000;
  if (text.size() > max_bytes) text = text.substr(0, max_bytes) + " ...";
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  log_.write(reply.accepted ? logging::Level::info : logging::Level::warning, text, clocks::steady_now());
}

void SettingsServer::publish_changes() {
  const auto changes = estimators_.with([](auto& all) { return all.take_settings_changes(); });
  for (const SettingsChange& change : changes) publish(change);
}

void SettingsServer::publish(const SettingsChange& change) {
  publish(settings_writer_, {.address = change.address,
                             .from_sequence = change.from_sequence,
                             .values = config::texts_of(change.settings)});
}

void SettingsServer::publish_changed(BeaconAddress address) {
  for (EffectiveSettings& each : changed_settings_.update(address)) {
    publish(changed_writer_, std::move(each));
  }
}

void SettingsServer::publish(dds::pub::DataWriter<sonopose_EffectiveSettings>& writer,
                             EffectiveSettings settings) {
  settings.time_ns = clocks::host_now();
  const auto sample = topics::to_idl(settings);
  write([&] { return dds::ext::try_write(writer, sample.sample()); });
}

/// Repeats `attempt` until a slow reader has space or the process ends.
void SettingsServer::write(const auto& attempt) {
  const auto give_up = [this] { return stopping_.load(); };
  if (dds::ext::retry_unless(give_up, attempt) < 0) unwritten_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace sonopose::fusion
