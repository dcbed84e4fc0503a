// Writes seeds for the fuzzers of binary formats and of log folders: make_corpus FOLDER. They are in
// fuzz/corpus; run it again when a format or the IDL changes.

#include "cdr_type.hpp"
#include "marvelmind/disassembler.hpp"
#include "marvelmind/encoder.hpp"
#include "mcap/encoder.hpp"
#include "mcap/writer.hpp"
#include "recording/log_columns.hpp"
#include "recording/log_writer.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <iterator>
#include <span>
#include <string>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;
namespace fs = std::filesystem;

namespace {

using Bytes = std::vector<std::uint8_t>;

void write(const fs::path& file, std::span<const std::uint8_t> bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void append(Bytes& bytes, std::span<const std::uint8_t> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// Marvelmind

/// Packets of 0.2 s, as a beacon with this clock sends them.
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

/// One packet of each kind and layout.
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
    packets.emplace_back(RawDistances{.address = 7, .time = stamp});
    packets.emplace_back(VendorFusion{.quaternion = {10000, 0, 0, 0}, .address = 7, .time = stamp});
  }
  packets.emplace_back(Telemetry{.battery_mv = 3900, .rssi_dbm = -60, .address = 7});
  for (const bool in_cm : {false, true}) {
    StationaryBeacons beacons{.in_cm = in_cm, .count = 2};
    beacons.items[0] = {.address = 1, .xyz_mm = {10, 20, 30}};
    packets.emplace_back(beacons);
  }
  packets.emplace_back(Waypoint{.type = 1, .index = 0, .total = 3});
  packets.emplace_back(UserData{.time_ms = 1'700'000'000'000, .size = 3});
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

// MCAP

/// The bytes of a file.
class MemorySink final : public mcap::ByteSink {
public:
  void append(std::span<const std::byte> bytes) override { mcap::put_bytes(content, bytes); }
  void reserve(std::uint64_t) override {}

  mcap::Bytes content;
};

/// A small file of each compression, and one that was cut.
void write_mcap(const fs::path& folder) {
  for (const auto compression : {mcap::Compression::none, mcap::Compression::lz4, mcap::Compression::zstd}) {
    MemorySink sink;
    mcap::Writer writer(sink, {.compression = compression});
    const auto channel = writer.add_channel(writer.add_schema("S", "omgidl", "struct S {};"), "t", "cdr");
    for (std::uint32_t i = 0; i < 4; ++i) {
      writer.write({channel, i, 100 - i, 90, std::as_bytes(std::span("sample sample"))});
      if (i % 2 == 1) writer.end_chunk();
    }
    writer.write_metadata({"m", {{"a", "b"}}});
    writer.close();
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(sink.content.data());
    const std::string name(compression == mcap::Compression::none ? "plain" : name_of(compression));
    write(folder / name, {bytes, sink.content.size()});
    write(folder / (name + "_cut"), {bytes, sink.content.size() / 3});
  }
}

// DDS

/// Byte 0 of the input of the fuzzers of serialized samples, then a sample.
template <class T>
void write_sample(const fs::path& folder, int index, const T& sample) {
  static const CdrType<T> type;
  Bytes bytes{static_cast<std::uint8_t>(index)};
  append(bytes, type.bytes_of(sample));
  write(folder / std::to_string(index), bytes);
}

void write_dds_samples(const fs::path& folder) {
  int index = 0;
  const auto write_topic = [&]<class T>(const dds::topics::Entry<T>& /*entry*/) {
    if constexpr (std::is_same_v<T, sonopose_ResetCommand>) {
      write_sample(folder, index, T{.address = 7, .request_id = 1});
    } else {
      auto native = decltype(dds::topics::from_idl(T{})){};
      if constexpr (requires { native.address; }) native.address = 7;
      if constexpr (requires { native.assignments; }) native.assignments = {{"trust.sigma_m", "0.1"}};
      if constexpr (requires { native.values; }) native.values = {{"trust.sigma_m", "0.1"}};
      if constexpr (requires { dds::topics::to_idl(native).sample(); }) {
        const auto view = dds::topics::to_idl(native);
        write_sample(folder, index, view.sample());
      } else {
        write_sample(folder, index, dds::topics::to_idl(native));
      }
    }
    ++index;
  };
  std::apply([&](const auto&... entry) { (write_topic(entry), ...); }, dds::topics::all);
}

void write_ros2_messages(const fs::path& folder) {
  const std::string frame = "map";
  const auto with_header = [&frame](auto message) {
    message.header.stamp = {1'700'000'000, 5};
    message.header.frame_id = ros2::borrow_string(frame);
    return message;
  };
  ros2::PoseWithCovarianceStamped pose{};
  pose.pose.covariance[0] = 0.04;
  write_sample(folder, 0, with_header(ros2::Imu{}));
  write_sample(folder, 1, with_header(ros2::PointStamped{}));
  write_sample(folder, 2, with_header(pose));
  write_sample(folder, 4, ros2::Clock{});
  std::vector<ros2::Parameter> parameters(1);
  parameters[0].name = ros2::borrow_string(frame);
  parameters[0].value.type = 3;
  ros2::SetParameters::Request request{};
  ros2::borrow_sequence(request.parameters, parameters);
  write_sample(folder, 6, request);
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
  write_mcap(corpus / "mcap");
  write_dds_samples(corpus / "dds_samples");
  write_ros2_messages(corpus / "ros2_messages");
}
