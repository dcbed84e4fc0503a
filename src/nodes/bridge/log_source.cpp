#include "bridge/log_source.hpp"

#include "bridge/pacer.hpp"
#include "bridge/shifted.hpp"
#include "bus_log/sensor_log.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"

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
    for (const Event& event : log_.events) {
      const TimeNs time_ns = available_at_ns(event);
      if (!pacer_.wait_for(time_ns, sink, stop)) return;
      for (; truth != log_.truth.end() && truth->time_ns <= time_ns; ++truth) {
        sink.on(shifted(*truth, shift_ns));
      }
      sink.on(shifted(event, shift_ns));
    }
  }

private:
  Pacer pacer_;
  bool restamp_;
  recording::SensorLog log_;
};

}  // namespace

std::unique_ptr<publication::Source> make_log_source(const LogOptions& options) {
  return std::make_unique<LogSource>(options);
}

}  // namespace sonopose::bridge
