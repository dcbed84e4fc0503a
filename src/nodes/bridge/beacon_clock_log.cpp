#include "bridge/beacon_clock_log.hpp"

#include <sonopose/text/count_text.hpp>
#include <sonopose/text/duration_text.hpp>

#include <fmt/format.h>

#include <cmath>

namespace sonopose::bridge {

namespace {

std::string step_text(BeaconAddress address, std::uint64_t count, std::int64_t step_ns) {
  const double step_s = static_cast<double>(step_ns) * 1e-9;
  return fmt::format("beacon {}: its clock was set {} by {}, or it restarted{}", address,
                     step_ns < 0 ? "back" : "ahead", text::duration_text(std::abs(step_s)),
                     count > 1 ? fmt::format(" (the last of {} steps)", count) : "");
}

}  // namespace

std::optional<std::string> stamps_too_late_text(const marvelmind::BeaconAssembler& beacon) {
  const std::uint64_t count = beacon.counters().stamps_too_late;
  if (count == 0) return std::nullopt;
  return fmt::format("{} of beacon {} {} stamped in the year 2100 or later, and not used: set its clock",
                     text::count_text(count, "sample"), beacon.address(), count == 1 ? "is" : "are");
}

std::vector<std::string> BeaconClockLog::update(const marvelmind::Assembler& assembler) {
  const bool is_live = mapping_ == marvelmind::TimeMapping::fitted;
  std::vector<std::string> lines;
  for (const BeaconAddress address : assembler.addresses()) {
    const marvelmind::BeaconAssembler& beacon = *assembler.beacon(address);
    const marvelmind::ClockSteps steps = beacon.clock_steps();
    Reported& reported = reported_[address];
    if (steps.count < reported.steps) reported = {};  // the beacon was gone
    if (steps.count > reported.steps) {
      lines.push_back(step_text(address, steps.count - reported.steps, steps.newest_ns));
      reported.steps = steps.count;
    }
    if (!is_live || reported.has_late_stamps) continue;
    if (auto text = stamps_too_late_text(beacon)) {
      reported.has_late_stamps = true;
      lines.push_back(*std::move(text));
    }
  }
  return lines;
}

}  // namespace sonopose::bridge
