#include <sonopose/io/log_folder.hpp>
#include <sonopose/nodes/host_clock.hpp>
#include <sonopose/nodes/recorded_sources.hpp>

namespace sonopose::nodes {
namespace {

/// The same event `shift_ns` later.
Event shifted(Event event, TimeNs shift_ns) {
  if (auto* imu = std::get_if<ImuSample>(&event)) {
    imu->sensor_time_ns += shift_ns;
  } else if (auto* fix = std::get_if<UltrasonicFix>(&event)) {
    fix->emission_time_ns += shift_ns;
    fix->received_time_ns += shift_ns;
  } else {
    auto& heading = std::get<PairHeading>(event);
    heading.emission_time_ns += shift_ns;
    heading.received_time_ns += shift_ns;
  }
  return event;
}

class LogSource final : public Source {
public:
  explicit LogSource(const LogOptions& options)
      : pacer_(options.rate),
        restamp_(options.restamp),
        log_(io::read_sensor_log(options.folder, options.address)) {}

  [[nodiscard]] bool is_recording() const override { return true; }

  void run(SampleSink& sink, const StopSignal& stop) override {
    if (log_.events.empty()) return;
    const TimeNs shift_ns = restamp_ ? now_ns() - available_at_ns(log_.events.front()) : 0;
    auto truth = log_.truth.begin();
    for (const Event& event : log_.events) {
      const TimeNs time_ns = available_at_ns(event);
      if (!pacer_.wait_for(time_ns, sink, stop)) return;
      for (; truth != log_.truth.end() && truth->time_ns <= time_ns; ++truth) {
        TruthSample moved = *truth;
        moved.time_ns += shift_ns;
        sink.on(moved);
      }
      sink.on(shifted(event, shift_ns));
    }
  }

private:
  Pacer pacer_;
  bool restamp_;
  io::SensorLog log_;
};

}  // namespace

std::unique_ptr<Source> make_log_source(const LogOptions& options) {
  return std::make_unique<LogSource>(options);
}

}  // namespace sonopose::nodes
