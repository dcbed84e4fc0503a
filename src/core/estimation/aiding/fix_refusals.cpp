#include <sonopose/estimation/aiding/fix_refusals.hpp>
#include <sonopose/settings/settings_table.hpp>
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/number_text.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace sonopose::estimation::aiding {
namespace {

std::string text_of(const ExceededLimit& limit) {
  return "above " + std::string(limit.key) + " (" + settings::to_text(limit.value) + ")";
}

}  // namespace

bool RefusedFixes::on(const FixReport& report) noexcept {
  const auto cause = refusal_of(report);
  if (!cause) return false;
  Refused& refused = refused_.at(static_cast<std::size_t>(*cause));
  ++refused.fixes;
  refused.age_s = seconds_between(report.emission_time_ns, report.applied_time_ns);
  return true;
}

std::uint64_t RefusedFixes::count() const {
  std::uint64_t count = 0;
  for (const Refused& refused : refused_) count += refused.fixes;
  return count;
}

FixRefusal RefusedFixes::most_frequent() const {
  const auto most = std::max_element(refused_.begin(), refused_.end(),
                                     [](const Refused& a, const Refused& b) { return a.fixes < b.fixes; });
  return static_cast<FixRefusal>(most - refused_.begin());
}

bool RefusedFixes::are_of_another_clock() const {
  const FixRefusal cause = most_frequent();
  return count() > 0 && (cause == FixRefusal::too_old || cause == FixRefusal::too_new);
}

std::string RefusedFixes::reason() const {
  if (count() == 0) return "";
  const FixRefusal cause = most_frequent();
  const Refused& most = refused_.at(static_cast<std::size_t>(cause));
  const std::string share =
      most.fixes < count() ? std::to_string(most.fixes) + " of them for this reason: " : "";
  if (most.fixes < 2 * positions_.samples) return share + "a coordinate is " + text_of(positions_.limit);
  switch (cause) {
    case FixRefusal::low_quality:
      return share + "their quality is below admission.min_quality_percent";
    case FixRefusal::no_imu:
      if (imu_.samples == 0) return share + "no IMU sample has arrived";
      return share + text::count_text(imu_.samples, "IMU sample was", "IMU samples were") + " refused, " +
             (imu_.limit.key == nullptr ? "with a specific force of zero" : text_of(imu_.limit));
    case FixRefusal::too_old:
      return share + "the latest is " + text::number_text(most.age_s, 3) +
             " s older than the IMU samples, more than admission.max_fix_age_s";
    case FixRefusal::too_new:
      return share + "the latest is " + text::number_text(-most.age_s, 3) +
             " s newer than the IMU samples: set the clocks";
    case FixRefusal::invalid:
      break;
  }
  return share + "the latest is not newer than the one before, or its position or its times are out of range";
}

void FixRefusals::on(const Event& event, const settings::AdmissionSettings& settings) noexcept {
  if (const auto* imu = std::get_if<ImuSample>(&event)) refused_.on(*imu, settings);
  const auto* const fix = std::get_if<UltrasonicFix>(&event);
  if (fix == nullptr) return;
  is_set_pose_ = (fix->flags & ultrasonic_flag_set_pose) != 0U;
  if (is_set_pose_) set_pose_ = refused_.imu_alone();
  (is_set_pose_ ? set_pose_ : refused_).on(*fix, settings);
}

void FixRefusals::on(const FixReport& report) noexcept {
  if (std::exchange(is_set_pose_, false)) {
    set_pose_.on(report);
    return;
  }
  if (refused_.on(report)) return;
  refused_ = {};
  since_.reset();
}

std::optional<std::string> FixRefusals::update(SteadyTime now) {
  if (const RefusedFixes refused = std::exchange(set_pose_, {}); refused.count() > 0) {
    return "the pose that the user has set is refused: " + refused.reason();
  }
  if (!since_) {  // none refused, or one accepted since the last call
    if (refused_.count() > 0) since_ = now;
    if (!std::exchange(reported_, false)) return std::nullopt;
    return "fixes are accepted again";
  }
  if (reported_ || refused_.count() < 2 || now - *since_ < timeout_ns) return std::nullopt;
  reported_ = true;
  return "all fixes are refused, " + std::to_string(refused_.count()) + " until now: " + refused_.reason();
}

}  // namespace sonopose::estimation::aiding
