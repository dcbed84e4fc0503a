#include "recording/merge.hpp"

#include "recording/look_ahead.hpp"
#include "recording/merged_streams.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <variant>

namespace sonopose::recording {
namespace {

/// The IMU samples among events, one at a time.
class ImuOfEvents {
public:
  explicit ImuOfEvents(const std::vector<Event>& events) : events_(events) { find(); }
  [[nodiscard]] const ImuSample* current() const {
    return next_ < events_.size() ? std::get_if<ImuSample>(&events_[next_]) : nullptr;
  }
  void step() {
    ++next_;
    find();
  }
  [[nodiscard]] std::size_t expected_count() const { return events_.size() - next_; }

private:
  void find() {
    while (next_ < events_.size() && !std::holds_alternative<ImuSample>(events_[next_])) ++next_;
  }

  const std::vector<Event>& events_;
  std::size_t next_ = 0;
};

}  // namespace

void leave_far_ahead_out(const std::string& name, SensorLog& log) {
  std::vector<Event>& events = log.events;
  LookAhead imu{ImuOfEvents(events)};
  std::vector<std::uint64_t> kept;
  for (; imu.current() != nullptr; imu.step()) kept.push_back(imu.current()->sequence);
  std::vector<std::string> warnings = imu.warnings(name);
  if (warnings.empty()) return;
  auto next = kept.begin();
  std::erase_if(events, [&](const Event& event) {
    if (!std::holds_alternative<ImuSample>(event)) return false;
    const bool is_kept = next != kept.end() && *next == sequence_of(event);
    if (is_kept) ++next;
    return !is_kept;
  });
  std::uint64_t sequence = 0;
  for (Event& event : events) std::visit([&](auto& sample) { sample.sequence = ++sequence; }, event);
  std::ranges::move(warnings, std::back_inserter(log.warnings));
}

SensorLog merge_by_availability(const std::string& name, const std::vector<ImuSample>& imu,
                                const std::vector<UltrasonicFix>& fixes,
                                const std::vector<PairHeading>& headings,
                                const std::vector<TwistSample>& twists) {
  const auto open_imu = [&imu] { return Samples(imu); };
  return merged(name, open_imu(), open_imu, Samples(fixes), Samples(headings), Samples(twists));
}

}  // namespace sonopose::recording
