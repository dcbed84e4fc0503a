#include "bus_log/dashboard_log.hpp"

#include "files/error.hpp"
#include "files/line_reader.hpp"
#include "files/missing.hpp"
#include "marvelmind/assembler.hpp"
#include "marvelmind/dashboard_line.hpp"
#include "recording/log_columns.hpp"
#include "recording/merge.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::bus_log {

namespace {

using marvelmind::DashboardLine;

constexpr std::string_view zstd_magic = "\x28\xb5\x2f\xfd";

/// The samples of one beacon in file order.
struct Streams {
  std::vector<ImuSample> imu;
  std::vector<UltrasonicFix> fixes;
  std::vector<PairHeading> headings;

  void add(const ImuSample& sample) { imu.push_back(sample); }
  void add(const UltrasonicFix& fix) { fixes.push_back(fix); }
  void add(const PairHeading& heading) { headings.push_back(heading); }
  void add(const TwistSample& /*twist*/) {}  // a beacon measures none
};

struct Dashboard {
  std::map<BeaconAddress, Streams> beacons;
  std::vector<std::string> warnings;
  std::optional<std::string> first_line;
  bool has_line = false;  ///< a line has the timestamp of such a log
};

Dashboard read_all(const std::filesystem::path& file) {
  Dashboard read;
  marvelmind::Assembler assembler(marvelmind::TimeMapping::fixed);
  const auto add = [&read](const Event& event) {
    std::visit([&](const auto& sample) { read.beacons[sample.address].add(sample); }, event);
  };
  std::size_t invalid = 0;
  std::string first_problem;
  files::LineReader lines(file);
  while (const auto line = lines.next()) {
    if (!read.first_line) read.first_line = *line;
    if (line->empty()) continue;
    const DashboardLine parsed = marvelmind::parse_dashboard_line(*line);
    read.has_line = read.has_line || parsed.time_ns != 0;
    if (parsed.kind == DashboardLine::Kind::packet) assembler.on(parsed.packet, parsed.time_ns, add);
    if (parsed.kind != DashboardLine::Kind::invalid) continue;
    if (invalid++ == 0) first_problem = fmt::format("line {}, {}", lines.number(), parsed.problem);
  }
  assembler.finish(add);
  if (invalid > 0) {
    read.warnings.push_back(fmt::format("{}: {} cannot be read; the first: {}", file.string(),
                                        text::count_text(invalid, "line"), first_problem));
  }
  return read;
}

}  // namespace

recording::SensorLog read_dashboard_log(const std::filesystem::path& file,
                                        std::optional<BeaconAddress> address) {
  Dashboard read = read_all(file);
  std::string known;
  for (const auto& [beacon, streams] : read.beacons)
    known += (known.empty() ? "" : ", ") + std::to_string(beacon);
  if (!read.has_line && files::is_present(file.parent_path() / recording::imu_file)) {
    throw files::IoError(fmt::format("{}: is in a log folder; give the folder, {}", file.string(),
                                     file.has_parent_path() ? file.parent_path().string() : "."));
  }
  if (!read.has_line && !read.first_line) throw files::IoError(file.string() + ": is empty");
  if (!read.has_line && read.first_line->starts_with(zstd_magic)) {
    throw files::IoError(
        fmt::format("{}: is compressed as a whole: expand it with zstd -d {}", file.string(), file.string()));
  }
  if (!read.has_line) {
    throw files::IoError(
        file.string() +
        ": is not an MCAP file, which begins with its magic bytes, and no line is of a CSV log of the "
        "Dashboard, which begins with a time as in T2024_01_31__120000_000");
  }
  if (known.empty()) throw files::IoError(file.string() + ": has no position and no IMU sample");
  if (!address && read.beacons.size() > 1) {
    throw files::IoError(fmt::format("{}: has {} beacons; choose one with --beacon: {}", file.string(),
                                     read.beacons.size(), known));
  }
  const auto found = address ? read.beacons.find(*address) : read.beacons.begin();
  if (found == read.beacons.end()) {
    throw files::IoError(fmt::format("{}: has no beacon {}; it has {}", file.string(), *address, known));
  }
  const Streams& streams = found->second;
  recording::SensorLog log =
      recording::merge_by_availability(file.string(), streams.imu, streams.fixes, streams.headings);
  log.address = found->first;
  log.warnings.insert(log.warnings.begin(), read.warnings.begin(), read.warnings.end());
  return log;
}

}  // namespace sonopose::bus_log
