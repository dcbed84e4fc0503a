#include "evaluation/report/exported.hpp"

#include "bus_log/outputs.hpp"
#include "bus_log/recording_files.hpp"
#include "bus_log/sensor_log.hpp"
#include "evaluation/report/output_folder.hpp"
#include "recording/log_writer.hpp"

namespace sonopose::evaluation {

ExportResult export_recording(const std::vector<std::filesystem::path>& paths,
                              std::optional<BeaconAddress> address, const std::filesystem::path& folder) {
  std::optional<mcap::Reader> reader;  // SQLite is of rosbag2, without outputs of the fusion
  if (!bus_log::is_in_sqlite(paths)) reader.emplace(bus_log::recording_files(paths));
  const recording::SensorLog log = bus_log::read_sensor_log(paths, address);
  recording::SensorLogWriter writer(folder);
  for (const Event& event : log.events) writer.write(event);
  for (const TruthSample& truth : log.truth) writer.write(truth);
  writer.flush();
  ExportResult result;
  result.events = log.events.size();
  result.misread = writer.misread();
  if (!reader) return result;
  OutputFolder outputs(folder);
  bus_log::for_each_output(
      *reader, log.address,
      [&](const FusedPose& pose) {
        outputs.write(pose);
        ++result.poses;
      },
      [&](const FixReport& report) {
        outputs.write(report);
        ++result.reports;
      });
  if (result.poses + result.reports > 0) outputs.finish();
  return result;
}

}  // namespace sonopose::evaluation
