#include "fusion/fix_refusals.hpp"

#include <fmt/format.h>

#include <utility>

namespace sonopose::fusion {

void FixRefusals::on(const FixReport& report) noexcept {
  constexpr std::uint32_t refusals = fix_too_late | fix_invalid | fix_low_quality;
  if ((report.flags & refusals) == 0) {
    refused_ = 0;
    since_.reset();
    return;
  }
  ++refused_;
  latest_ = report;
}

std::optional<std::string> FixRefusals::update(SteadyTime now) {
  if (!since_) {  // none refused, or one accepted since the last call
    if (refused_ > 0) since_ = now;
    if (!std::exchange(reported_, false)) return std::nullopt;
    return "fixes are accepted again";
  }
  if (reported_ || refused_ < 2 || now - *since_ < timeout_ns) return std::nullopt;
  reported_ = true;
  return fmt::format("all fixes are refused, {} until now: {}", refused_, reason());
}

std::string FixRefusals::reason() const {
  if ((latest_.flags & fix_low_quality) != 0) return "their quality is below admission.min_quality_percent";
  if (latest_.applied_time_ns == 0) return "no IMU sample has arrived";
  const double age_s = seconds_between(latest_.emission_time_ns, latest_.applied_time_ns);
  if ((latest_.flags & fix_too_late) != 0) {
    return fmt::format("the latest is {:.3f} s older than the IMU samples, more than admission.max_fix_age_s",
                       age_s);
  }
  if (age_s < 0)
    return fmt::format("the latest is {:.3f} s newer than the IMU samples: set the clocks", -age_s);
  return "the latest is not newer than the one before, or its position or its times are out of range";
}

}  // namespace sonopose::fusion
