#include "transitions/fix_refusals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace sonopose::transitions {

void FixRefusals::on(const FixReport& report) noexcept {
  const auto cause = refusal_of(report);
  if (!cause) {
    refused_ = {};
    since_.reset();
    return;
  }
  Refused& refused = refused_.at(static_cast<std::size_t>(*cause));
  ++refused.fixes;
  refused.age_s = seconds_between(report.emission_time_ns, report.applied_time_ns);
}

std::uint64_t FixRefusals::count() const {
  std::uint64_t count = 0;
  for (const Refused& refused : refused_) count += refused.fixes;
  return count;
}

std::optional<std::string> FixRefusals::update(SteadyTime now) {
  if (!since_) {  // none refused, or one accepted since the last call
    if (count() > 0) since_ = now;
    if (!std::exchange(reported_, false)) return std::nullopt;
    return "fixes are accepted again";
  }
  if (reported_ || count() < 2 || now - *since_ < timeout_ns) return std::nullopt;
  reported_ = true;
  return fmt::format("all fixes are refused, {} until now: {}", count(), reason());
}

std::string FixRefusals::reason() const {
  if (count() == 0) return "";
  const auto most = std::max_element(refused_.begin(), refused_.end(),
                                     [](const Refused& a, const Refused& b) { return a.fixes < b.fixes; });
  const std::string share =
      most->fixes < count() ? fmt::format("{} of them for this reason: ", most->fixes) : "";
  switch (static_cast<FixRefusal>(most - refused_.begin())) {
    case FixRefusal::low_quality:
      return share + "their quality is below admission.min_quality_percent";
    case FixRefusal::no_imu:
      return share + "no IMU sample has arrived";
    case FixRefusal::too_old:
      return fmt::format(
          "{}the latest is {:.3f} s older than the IMU samples, more than admission.max_fix_age_s", share,
          most->age_s);
    case FixRefusal::too_new:
      return fmt::format("{}the latest is {:.3f} s newer than the IMU samples: set the clocks", share,
                         -most->age_s);
    case FixRefusal::invalid:
      break;
  }
  return share + "the latest is not newer than the one before, or its position or its times are out of range";
}

}  // namespace sonopose::transitions
