// Parses the lines of a CSV log of the vendor's Dashboard, the samples of their packets, and the log as a
// recording.

#include "bus_log/sensor_log.hpp"
#include "marvelmind/assembler.hpp"
#include "marvelmind/dashboard_line.hpp"
#include "sensor_logs.hpp"
#include "support.hpp"

#include <optional>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

void check_lines(std::string_view input) {
  const std::size_t size = input.size();
  using marvelmind::DashboardLine;
  marvelmind::Assembler assembler(marvelmind::TimeMapping::fixed);
  std::size_t samples = 0;
  const auto count = [&samples](const Event& event) {
    promise(address_of(event) <= 255, "the address is one of a line");
    ++samples;
  };
  while (!input.empty()) {
    const std::size_t end = input.find('\n');
    const DashboardLine line = marvelmind::parse_dashboard_line(input.substr(0, end));
    input = end == std::string_view::npos ? std::string_view() : input.substr(end + 1);
    promise(line.kind != DashboardLine::Kind::invalid || !line.problem.empty(),
            "an invalid line has a reason");
    if (line.kind == DashboardLine::Kind::packet) assembler.on(line.packet, line.time_ns, count);
  }
  assembler.finish(count);
  promise(samples <= 2 * size, "a line gives a few samples");
}

void check_recording(std::string_view input) {
  static const ScratchFolder folder;
  be_quiet();
  const auto file = folder.write("log.csv", input);
  for (const std::optional<BeaconAddress> address : {std::optional<BeaconAddress>(), {BeaconAddress{7}}}) {
    accepts<files::IoError>([&] {
      const recording::SensorLog log = bus_log::read_sensor_log(file, address);
      check_log(log, 2 * input.size());
      promise(!log.events.empty(), "a log without samples is refused");
    });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input = text_of(data, size);
  check_lines(input);
  check_recording(input);
  return 0;
}
