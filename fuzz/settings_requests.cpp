// Handles requests to change settings, as they arrive from the bus between events, and checks the replies.

#include "fusion/settings_requests.hpp"

#include "fused_events.hpp"
#include "fusion/beacon_estimators.hpp"
#include "support.hpp"
#include "threads/guarded.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

constexpr std::array<BeaconAddress, 3> addresses{7, 8, all_beacons};

std::vector<SettingAssignment> any_assignments(FuzzedDataProvider& data) {
  std::vector<SettingAssignment> assignments;
  const int count = data.ConsumeIntegralInRange(0, 12);
  for (int i = 0; i < count; ++i) {
    const std::string key = setting_key(data);
    assignments.push_back({key, setting_value(data, key)});
  }
  return assignments;
}

/// Returns assignments that are accepted or refused for reasons that random ones hardly ever meet.
std::vector<SettingAssignment> rare_assignments(FuzzedDataProvider& data) {
  switch (data.ConsumeIntegralInRange(0, 6)) {
    case 0:
      return {{"documented.trust.sigma_m", "0.5"}, {"documented.trust.sigma_m", "0.6"}};
    case 1:
      return {10, {"trust.sigma", "0.5"}};  // unknown key; more errors than are listed
    case 2:
      return {{"documented.attitude.magnetometer", "true"}};  // an error with the engine that ignores it
    case 3:
      return {{"fusion.engine", "documented"}, {"documented.attitude.magnetometer", "true"}};
    case 4:
      return {{"fusion.engine", "kalman"}};
    case 5:
      return {{"documented.drift.jump_alpha", "0.9"},
              {"documented.imu_weight", "low"}};  // one replaces the other
    default:
      return {{"documented.trust.sigma_m", "0.5"}};
  }
}

SettingsRequest any_request(FuzzedDataProvider& data) {
  SettingsRequest request;
  request.address = data.PickValueInArray(addresses);
  request.request_id = data.ConsumeIntegralInRange<std::uint64_t>(0, 100);
  request.from_sequence = data.ConsumeBool() ? data.ConsumeIntegralInRange<std::uint64_t>(0, 100)
                                             : data.ConsumeIntegral<std::uint64_t>();
  request.assignments = data.ConsumeBool() ? any_assignments(data) : rare_assignments(data);
  return request;
}

void check_settings(const fusion::SettingsChange& change) {
  const EffectiveSettings effective{.address = change.address, .values = config::texts_of(change.settings)};
  promise(sonopose::dds::topics::from_idl(sonopose::dds::topics::to_idl(effective).sample()) == effective,
          "the effective settings fit their topic");
}

/// Requests more changes than can wait for their events, and one that contradicts only a beacon's own
/// settings.
void fill_timeline(fusion::SettingsRequests& requests) {
  std::ignore = requests.answer({.address = 7, .assignments = {{"fusion.engine", "kalman"}}});
  std::ignore = requests.answer(
      {.address = all_beacons,
       .assignments = {{"fusion.engine", "documented"}, {"documented.attitude.magnetometer", "true"}}});
  constexpr std::uint64_t request_count = fusion::SettingsTimeline::capacity + 1;
  for (std::uint64_t i = 0; i < request_count; ++i) {
    const SettingsReply reply = requests.answer({.address = 7,
                                                 .request_id = 1000 + i,
                                                 .from_sequence = 1'000'000 + i,
                                                 .assignments = {{"documented.trust.sigma_m", "0.5"}}});
    promise(reply.accepted || !reply.reason.empty(), "a refusal has a reason");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  threads::Guarded<fusion::BeaconEstimators> estimators(config::FusionConfig{}, false);
  fusion::SettingsRequests requests(estimators);
  const auto estimator = estimators.with([](auto& all) { return all.find_or_make(addresses.front()); });
  constexpr TimeNs start_ns = 1'700'000'000'000'000'000;
  EventStream stream(data, start_ns, addresses.front());
  SteadyTime now{1'000'000'000};
  constexpr int max_steps = 300;
  for (int step = 0; step < max_steps && stream.has_more(); ++step) {
    const auto kind = data.ConsumeIntegral<std::uint8_t>();
    if (kind == 255) {
      fill_timeline(requests);
      continue;
    }
    if (kind < 128) {
      now += 5'000'000;
      estimator->collate(stream.next(), 0, now, now);
      while (const auto outcome = estimator->process_next()) {
        check_result(outcome->result);
        if (const auto change = estimator->take_settings_change()) check_settings(*change);
      }
      continue;
    }
    const SettingsRequest request = any_request(data);
    // A request that exceeds its type never reaches the bus.
    if (!accepts<std::length_error>([&] { sonopose::dds::topics::to_idl(request); })) continue;
    const SettingsReply reply =
        requests.answer(sonopose::dds::topics::from_idl(sonopose::dds::topics::to_idl(request).sample()));
    promise(reply.address == request.address && reply.request_id == request.request_id,
            "a reply names its request");
    promise(reply.accepted || !reply.reason.empty(), "a refusal has a reason");
    const SettingsReply sent = sonopose::dds::topics::from_idl(sonopose::dds::topics::to_idl(reply));
    promise(sent.reason.size() <= sonopose_MAX_REASON && sent.details.size() <= sonopose_MAX_DETAILS,
            "a reply fits its topic");
    if (request.request_id != 0) {
      promise(requests.answer(request) == reply, "a repeated request gets the first reply");
    }
    check_settings(estimators.with([](auto& all) { return all.settings_for_all(); }));
  }
  return 0;
}
