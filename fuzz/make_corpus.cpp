// Writes seeds for the fuzzers of binary formats and of log folders: make_corpus FOLDER. They are in
// fuzz/corpus; run it again when a format or the IDL changes.

#include "make_corpus.hpp"

#include "marvelmind/disassembler.hpp"
#include "marvelmind/encoder.hpp"
#include "recording/log_columns.hpp"
#include "recording/log_writer.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <iterator>
#include <string>
#include <type_traits>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;
namespace fs = std::filesystem;

namespace {

// Marvelmind

/// Returns packets of 0.2 s, as a beacon with this clock sends them.
std::vector<marvelmind::Packet> packets_of(marvelmind::TimeBase time_base) {
  sim::Run run;
  run.duration_s = 0.2;
  marvelmind::Disassembler disassembler({.time_base = time_base, .beacon_zero_ns = run.start_time_ns});
  std::vector<marvelmind::Packet> packets;
  const auto keep = [&packets](const marvelmind::Packet& packet) { packets.push_back(packet); };
  for (const Event& event : sim::record(sim::find_scenario("kart"), run).events) {
    disassembler.on(event, keep);
  }
  disassembler.flush(keep);
  return packets;
}

/// Returns one packet of each kind and layout.
std::vector<marvelmind::Packet> packets_of_each_kind() {
  using namespace marvelmind;
  std::vector<Packet> packets;
  for (const TimeBase base : {TimeBase::uptime_ms, TimeBase::uptime_64ths, TimeBase::unix_ms}) {
    const Stamp stamp{base, 1'700'000'000};
    Position position{.time = stamp, .xyz_mm = {1000, -2000, 300}, .address = 7};
    packets.emplace_back(position);
    position.in_cm = base != TimeBase::unix_ms;
    position.speed_mmps = {100, 0, -50};
    packets.emplace_back(position);
    packets.emplace_back(Quality{.address = 7, .quality_percent = 90});
    if (base == TimeBase::uptime_64ths) continue;
    packets.emplace_back(RawImu{.accel = {0, 0, 1000}, .address = 7, .time = stamp});
  }
  packets.emplace_back(Telemetry{.battery_mv = 3900, .rssi_dbm = -60, .address = 7});
  for (const bool in_cm : {false, true}) {
    StationaryBeacons beacons{.in_cm = in_cm, .count = 2};
    beacons.items[0] = {.address = 1, .xyz_mm = {10, 20, 30}};
    packets.emplace_back(beacons);
  }
  return packets;
}

void write_marvelmind(const fs::path& corpus) {
  const auto write_both = [&corpus](const char* name, const std::vector<marvelmind::Packet>& packets) {
    Bytes stream;
    Bytes datagrams;
    for (const marvelmind::Packet& packet : packets) {
      append(stream, marvelmind::encode(packet).bytes());
      const auto datagram = marvelmind::encode_datagram(packet);
      datagrams.push_back(static_cast<std::uint8_t>(datagram.bytes().size()));
      append(datagrams, datagram.bytes());
    }
    stream.push_back(0x41);  // pieces of one byte, 16 ms apart, a fitted clock
    write(corpus / "marvelmind_stream" / name, stream);
    write(corpus / "marvelmind_datagrams" / name, datagrams);
  };
  write_both("uptime", packets_of(marvelmind::TimeBase::uptime_ms));
  write_both("unix_time", packets_of(marvelmind::TimeBase::unix_ms));
  write_both("each_kind", packets_of_each_kind());
}

// Log folders

void write_log(const fs::path& corpus) {
  const ScratchFolder scratch;
  sim::Run run;
  run.duration_s = 0.2;
  const sim::Recording recording = sim::record(sim::find_scenario("kart"), run);
  {
    recording::SensorLogWriter log(scratch.path());
    for (const Event& event : recording.events) log.write(event);
    for (std::size_t i = 0; i < recording.truth.size(); i += 4) log.write(recording.truth[i]);
    log.flush();
  }
  std::string text;
  for (const auto name : {recording::meta_file, recording::imu_file, recording::ultrasonic_file,
                          recording::heading_file, recording::truth_file}) {
    std::ifstream file(scratch.path() / name, std::ios::binary);
    text += "== " + std::string(name) + "\n" + std::string(std::istreambuf_iterator<char>(file), {});
  }
  text += "== movement.csv\n#start [ns],end [ns]\n1,2\n";
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  write(corpus / "log_folder" / "kart", {bytes, text.size()});
}

// DDS

/// Writes a seed for the fuzzers that take one sample of any topic.
template <class T>
void write_topic_sample(const fs::path& corpus, int index, const T& sample) {
  for (const char* const fuzzer : {"dds_samples", "play_messages"})
    write_sample(corpus / fuzzer, index, sample);
}

void write_dds_samples(const fs::path& corpus) {
  int index = 0;
  const auto write_topic = [&]<class T>(const sonopose::dds::topics::Entry<T>& /*entry*/) {
    if constexpr (std::is_same_v<T, sonopose_ResetCommand>) {
      write_topic_sample(corpus, index, T{.address = 7, .request_id = 1});
    } else {
      auto native = decltype(sonopose::dds::topics::from_idl(T{})){};
      if constexpr (requires { native.address; }) native.address = 7;
      if constexpr (requires { native.assignments; })
        native.assignments = {{"documented.trust.sigma_m", "0.1"}};
      if constexpr (requires { native.values; }) native.values = {{"documented.trust.sigma_m", "0.1"}};
      if constexpr (requires { sonopose::dds::topics::to_idl(native).sample(); }) {
        const auto view = sonopose::dds::topics::to_idl(native);
        write_topic_sample(corpus, index, view.sample());
      } else {
        write_topic_sample(corpus, index, sonopose::dds::topics::to_idl(native));
      }
    }
    ++index;
  };
  std::apply([&](const auto&... entry) { (write_topic(entry), ...); }, sonopose::dds::topics::all);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "make_corpus FOLDER\n");
    return 2;
  }
  const fs::path corpus = argv[1];
  write_marvelmind(corpus);
  write_log(corpus);
  write_mcap_corpus(corpus / "mcap");
  write_dds_samples(corpus);
  write_ros2_corpus(corpus / "ros2_messages");
}
