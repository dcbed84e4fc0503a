// The lines of a CSV log of the vendor's Dashboard, and the samples of their packets.

#include "marvelmind/assembler.hpp"
#include "marvelmind/dashboard_line.hpp"
#include "support.hpp"

using namespace sonopose;
using namespace sonopose::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using marvelmind::DashboardLine;
  marvelmind::Assembler assembler(marvelmind::TimeMapping::fixed);
  std::size_t samples = 0;
  const auto count = [&samples](const Event& event) {
    promise(address_of(event) <= 255, "the address is one of a line");
    ++samples;
  };
  std::string_view input = text_of(data, size);
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
  return 0;
}
