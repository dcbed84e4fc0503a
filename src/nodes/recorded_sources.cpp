#include <sonopose/io/byte_file.hpp>
#include <sonopose/io/log_folder.hpp>
#include <sonopose/marvelmind/disassembler.hpp>
#include <sonopose/marvelmind/encoder.hpp>
#include <sonopose/nodes/host_clock.hpp>
#include <sonopose/nodes/recorded_sources.hpp>
#include <sonopose/sim/scenario.hpp>

#include <limits>

namespace sonopose::nodes {
namespace {

/// Keeps the bytes that a real beacon would have sent.
class BeaconCapture {
public:
  BeaconCapture(const std::filesystem::path& file, TimeNs wake_up_ns)
      : file_(file), disassembler_({.beacon_zero_ns = wake_up_ns}) {}

  void on(const Event& event) {
    disassembler_.on(event, [this](const marvelmind::Packet& packet) {
      file_.append(marvelmind::encode(packet).bytes());
    });
  }

private:
  io::CaptureFile file_;
  marvelmind::Disassembler disassembler_;
};

sim::SensorSettings sensors_of(const SimulatorOptions& options) {
  sim::SensorSettings sensors = sim::find_scenario(options.scenario).sensors;
  if (options.imu_rate_hz) sensors.imu_rate_hz = *options.imu_rate_hz;
  return sensors;
}

class SimulatorSource final : public Source {
public:
  explicit SimulatorSource(const SimulatorOptions& options, TimeNs start_ns)
      : pacer_(options.rate),
        simulator_(sim::find_scenario(options.scenario), sensors_of(options),
                   {.seed = options.seed,
                    .start_time_ns = start_ns,
                    .address = options.address,
                    .duration_s = options.duration_s > 0 ? options.duration_s
                                                         : std::numeric_limits<double>::infinity()}) {
    // A beacon wakes up before it measures: its first stamp is not negative.
    constexpr TimeNs awake_before_ns = 1'000'000'000;
    if (options.capture) capture_.emplace(*options.capture, start_ns - awake_before_ns);
  }

  void run(SampleSink& sink, const StopSignal& stop) override {
    while (const auto step = simulator_.next()) {
      if (!pacer_.wait_for(available_at_ns(step->event), sink, stop)) return;
      if (step->truth) sink.on(*step->truth);
      sink.on(step->event);
      if (capture_) capture_->on(step->event);
    }
  }

private:
  Pacer pacer_;
  sim::Simulator simulator_;
  std::optional<BeaconCapture> capture_;
};

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

std::unique_ptr<Source> make_simulator_source(const SimulatorOptions& options) {
  return std::make_unique<SimulatorSource>(options, now_ns());
}

std::unique_ptr<Source> make_log_source(const LogOptions& options) {
  return std::make_unique<LogSource>(options);
}

}  // namespace sonopose::nodes
