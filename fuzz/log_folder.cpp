// A sensor-log folder. The input is its files one after the other, each after a line "== NAME".

#include "recording/log_folder.hpp"

#include "recording/attitude_log.hpp"
#include "recording/log_columns.hpp"
#include "support.hpp"

#include <algorithm>
#include <array>
#include <optional>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

constexpr std::array<std::string_view, 7> names{
    recording::imu_file,      recording::ultrasonic_file, recording::heading_file,    recording::truth_file,
    recording::movement_file, recording::meta_file,       recording::wheel_speed_file};

/// The text of one file; empty if the input does not have it.
std::optional<std::string_view> part_of(std::string_view input, std::string_view name) {
  const std::string title = "== " + std::string(name) + "\n";
  const std::size_t found = input.find(title);
  if (found == std::string_view::npos) return std::nullopt;
  const std::string_view text = input.substr(found + title.size());
  return text.substr(0, text.find("== "));
}

void check_log(const recording::SensorLog& log, std::size_t size) {
  promise(log.events.size() <= size, "a row of a file gives one event");
  std::uint64_t sequence = 0;
  for (const Event& event : log.events) {
    promise(sequence_of(event) == ++sequence, "events are numbered from 1");
    promise(address_of(event) == log.address, "all events have the address of the log");
    promise(available_at_ns(event) > 0 && available_at_ns(event) < TimeNs{1} << 62U, "a time is below 2^62");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ScratchFolder folder;
  const std::string_view input = text_of(data, size);
  for (const std::string_view name : names) {
    const auto text = part_of(input, name);
    if (text) {
      std::ignore = folder.write(name, *text);
    } else {
      std::filesystem::remove(folder.path() / name);
    }
  }
  accepts<files::IoError>([&] { check_log(recording::read_sensor_log(folder.path()), size); });
  accepts<files::IoError>([&] { recording::read_attitude_log(folder.path()); });
  accepts<files::IoError>([&] { recording::read_imu_log(folder.path()); });
  return 0;
}
