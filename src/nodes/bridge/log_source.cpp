#include "bridge/log_source.hpp"

#include "bridge/pacer.hpp"
#include "bridge/shifted.hpp"
#include "bus_log/sensor_log.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include <sonopose/text/duration_text.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <variant>

namespace sonopose::bridge {
namespace {

class LogSource final : public publication::Source {
public:
  explicit LogSource(const LogOptions& options)
      : pacer_(options.rate),
        restamp_(options.restamp),
        log_(bus_log::read_sensor_log(options.folder, options.address)) {
    if (log_.events.empty()) throw files::IoError(options.folder.string() + ": has no samples to play");
  }

  [[nodiscard]] bool is_recording() const override { return true; }

  void run(publication::SampleSink& sink, const process::StopSignal& stop) override {
    const TimeNs shift_ns =
        restamp_ ? saturated_difference(clocks::host_now(), available_at_ns(log_.events.front())) : 0;
    auto truth = log_.truth.begin();
    for (std::size_t i = 0; i < log_.events.size(); ++i) {
      const Event& event = log_.events[i];
      const TimeNs time_ns = available_at_ns(event);
      if (const double step_s = step_back_s(i); step_s > 0.0) {
        logging::warning(
            fmt::format("the clock of the log was set back by {}; playback "
                        "continues without a pause",
                        text::duration_text(step_s)));
        pacer_.restart_at(time_ns);
      }
      if (!pacer_.wait_for(time_ns, sink, stop)) return;
      for (; truth != log_.truth.end() && truth->time_ns <= time_ns; ++truth) {
        sink.on(shifted(*truth, shift_ns));
      }
      sink.on(shifted(event, shift_ns));
    }
  }

private:
  /// Size of a step back before this event that lasts, and that the IMU shows too; zero without one. A single
  /// stamp may be wrong, and other sensors may have another clock.
  [[nodiscard]] double step_back_s(std::size_t index) const {
    constexpr double min_step_s = 0.1;
    constexpr std::size_t events_to_last = 8;
    if (index == 0) return 0.0;
    const TimeNs before_ns = available_at_ns(log_.events[index - 1]);
    const double step_s = seconds_between(available_at_ns(log_.events[index]), before_ns);
    if (step_s < min_step_s) return 0.0;
    std::size_t older = 0;
    bool has_imu = false;
    for (std::size_t i = index; i < log_.events.size() && (older < events_to_last || !has_imu); ++i) {
      if (available_at_ns(log_.events[i]) >= before_ns) break;
      ++older;
      has_imu = has_imu || std::holds_alternative<ImuSample>(log_.events[i]);
    }
    return has_imu && older >= events_to_last ? step_s : 0.0;
  }

  Pacer pacer_;
  bool restamp_;
  recording::SensorLog log_;
};

}  // namespace

std::unique_ptr<publication::Source> make_log_source(const LogOptions& options) {
  return std::make_unique<LogSource>(options);
}

}  // namespace sonopose::bridge
