#include "formats/mcap/memory.hpp"
#include "make_corpus.hpp"
#include "mcap/decoder.hpp"
#include "mcap/encoder.hpp"
#include "mcap/writer.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/serialized_types.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sonopose::fuzz {
namespace {

using test::MemorySink;

void write_file(const fs::path& file, std::span<const std::byte> content) {
  write(file, {reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
}

/// Returns the file without checksums, so that changes are not rejected early.
mcap::Bytes without_checksums(mcap::Bytes file) {
  const auto clear = [&file](std::size_t at) {
    std::fill_n(file.begin() + static_cast<std::ptrdiff_t>(at), 4, std::byte{});
  };
  for (std::size_t at = mcap::magic.size(); at + mcap::record_prefix_bytes < file.size();) {
    const std::size_t content = at + mcap::record_prefix_bytes;
    const auto opcode = static_cast<mcap::Opcode>(file[at]);
    if (opcode == mcap::Opcode::chunk) clear(content + 3 * sizeof(std::uint64_t));
    if (opcode == mcap::Opcode::data_end) clear(content);
    if (opcode == mcap::Opcode::footer) clear(content + 2 * sizeof(std::uint64_t));
    at = content + static_cast<std::size_t>(mcap::load<std::uint64_t>(&file[at + 1]));
  }
  return file;
}

/// Replaces each occurrence of a text by one of the same length.
mcap::Bytes replaced(mcap::Bytes file, std::string_view text, std::string_view by) {
  const auto wanted = std::as_bytes(std::span(text));
  for (auto at = file.begin(); at != file.end(); ++at) {
    at = std::search(at, file.end(), wanted.begin(), wanted.end());
    if (at == file.end()) break;
    std::ranges::copy(std::as_bytes(std::span(by)), at);
  }
  return file;
}

/// Returns the file with a chunk that claims a byte less than its records have.
mcap::Bytes with_longer_records(mcap::Bytes file) {
  std::size_t at = mcap::magic.size();
  while (static_cast<mcap::Opcode>(file[at]) != mcap::Opcode::chunk) {
    at += mcap::record_prefix_bytes + static_cast<std::size_t>(mcap::load<std::uint64_t>(&file[at + 1]));
  }
  std::byte& lowest =
      file[at + mcap::record_prefix_bytes + 2 * sizeof(std::uint64_t)];  // lowest byte of uncompressed_size
  lowest = static_cast<std::byte>(std::to_integer<unsigned>(lowest) - 1U);
  return file;
}

/// Writes small files of each compression: whole, cut, without checksums, and damaged.
void write_mcap(const fs::path& folder) {
  constexpr std::array<std::uint64_t, 4> log_times_ns{100, 90, 95, 85};  // chunks overlap in time
  for (const auto compression : {mcap::Compression::none, mcap::Compression::lz4, mcap::Compression::zstd}) {
    MemorySink sink;
    mcap::Writer writer(sink, {.compression = compression});
    const auto channel = writer.add_channel(writer.add_schema("S", "omgidl", "struct S {};"), "t", "cdr",
                                            {{"k1", ""}, {"k2", ""}});
    for (std::uint32_t i = 0; i < log_times_ns.size(); ++i) {
      writer.write({channel, i, log_times_ns[i], 90, std::as_bytes(std::span("sample sample"))});
      if (i % 2 == 1) writer.end_chunk();
    }
    writer.write_metadata({"m", {{"k1", "b"}, {"k2", ""}}});
    writer.close();
    const std::string name(compression == mcap::Compression::none ? "plain" : name_of(compression));
    write_file(folder / name, sink.content);
    write_file(folder / (name + "_cut"), std::span(sink.content).first(sink.content.size() / 3));
    const mcap::Bytes unchecked = without_checksums(sink.content);
    write_file(folder / (name + "_unchecked"), unchecked);
    write_file(folder / (name + "_repeated_key"), replaced(unchecked, "k2", "k1"));
    write_file(folder / (name + "_longer_records"), with_longer_records(unchecked));
  }
}

/// A recording of the bus. Its schemas have no text, which would be most of the file.
class BusRecording {
public:
  /// Adds a sample at the next millisecond.
  template <class T>
  void add(const dds::topics::Entry<T>& topic, const T& sample, std::size_t cut_bytes = 0) {
    const std::vector<std::byte> bytes = dds::write_cdr(sample);
    const auto schema =
        writer_.add_schema(dds::TopicTraits<T>::descriptor().m_typename, "omgidl", schema_text);
    const auto data = std::span(bytes).first(bytes.size() - cut_bytes);
    log_time_ns_ += 1'000'000;
    writer_.write(
        {writer_.add_channel(schema, topic.name, encoding), ++sequence_, log_time_ns_, log_time_ns_, data});
  }
  void write_to(const fs::path& file) {
    writer_.close();
    write_file(file, without_checksums(sink_.content));
  }

  std::string schema_text = {};
  std::string encoding = "cdr";

private:
  MemorySink sink_;
  mcap::Writer writer_{sink_, {.compression = mcap::Compression::none}};
  std::uint64_t log_time_ns_ = 1'700'000'000'000'000'000;
  std::uint32_t sequence_ = 0;
};

/// Returns event `number` of a beacon.
template <class Sample>
Sample event(Sample sample, std::uint64_t number, BeaconAddress address = 7) {
  sample.address = address;
  sample.sequence = number;
  const TimeNs time_ns = 1'700'000'000'000'000'000 + static_cast<TimeNs>(number) * 1'000'000;
  if constexpr (std::is_same_v<Sample, ImuSample>) {
    sample.sensor_time_ns = time_ns;
  } else {
    sample.emission_time_ns = time_ns;
    sample.received_time_ns = time_ns;
  }
  return sample;
}

void write_bus_recordings(const fs::path& folder) {
  namespace topics = dds::topics;
  const auto imu = [](std::uint64_t number, BeaconAddress address = 7) {
    return topics::to_idl(event(ImuSample{}, number, address));
  };
  {
    BusRecording recording;
    recording.add(topics::imu, imu(2));
    recording.add(topics::fix, topics::to_idl(event(UltrasonicFix{}, 4)));
    recording.add(topics::heading, topics::to_idl(event(PairHeading{}, 3)));
    recording.add(topics::imu, imu(3));
    recording.add(topics::imu, imu(1000));
    recording.add(topics::truth, topics::to_idl(TruthSample{.address = 7, .time_ns = 5}));
    recording.add(topics::reset, sonopose_ResetCommand{.address = 7, .request_id = 1});
    for (const char* const value : {"1", "2"}) {
      const EffectiveSettings settings{.address = all_beacons,
                                       .values = {{"documented.trust.sigma_m", value}}};
      recording.add(topics::settings, topics::to_idl(settings).sample());
    }
    FusedPose pose;
    pose.address = 7;
    recording.add(topics::pose, topics::to_idl(pose));
    FixReport report;
    report.address = 7;
    recording.add(topics::report, topics::to_idl(report));
    recording.write_to(folder / "bus");
  }
  {
    BusRecording recording;
    recording.add(topics::imu, imu(1));
    recording.add(topics::imu, imu(1, 8));
    recording.write_to(folder / "bus_two_beacons");
  }
  {
    BusRecording recording;
    recording.add(topics::reset, sonopose_ResetCommand{.address = 7, .request_id = 1});
    recording.write_to(folder / "bus_no_beacon");
  }
  {
    BusRecording recording;
    recording.add(topics::imu, topics::to_idl(ImuSample{.address = 7}));
    recording.write_to(folder / "bus_no_time");
  }
  {
    BusRecording recording;
    recording.add(topics::imu, imu(1), 9);
    recording.write_to(folder / "bus_cut_sample");
  }
  {
    BusRecording recording;
    recording.encoding = "json";
    recording.add(topics::imu, imu(1));
    recording.write_to(folder / "bus_other_encoding");
  }
  {
    BusRecording recording;
    recording.add(topics::imu, imu(1));
    recording.schema_text = "struct EffectiveSettings { long a; }; // another version";
    recording.add(topics::settings, topics::to_idl(EffectiveSettings{.address = 7}).sample());
    recording.write_to(folder / "bus_other_settings");
  }
  {
    BusRecording recording;
    recording.schema_text = "/* another */ struct ImuSample { long a; };";
    recording.add(topics::imu, imu(1));
    recording.write_to(folder / "bus_other_imu");
  }
}

/// Recordings of rosbag2 with its definitions: of one IMU, and of two, between which nothing chooses.
void write_bags(const fs::path& folder) {
  for (const std::vector<std::string>& imus : {std::vector<std::string>{"/imu"}, {"/imu", "/other"}}) {
    MemorySink sink;
    mcap::Writer writer(sink, {.profile = "ros2", .compression = mcap::Compression::none});
    std::uint32_t sequence = 0;
    const auto add = [&]<class T>(const std::string& topic, const T& message) {
      const std::string type = dds::TopicTraits<T>::descriptor().m_typename;
      const auto schema =
          writer.add_schema(ros2::type_name_in_ros(type), "ros2msg", ros2::message_definition(type));
      const std::uint64_t time_ns = 1'700'000'000'000'000'000 + ++sequence;
      const auto data = dds::write_cdr(message);
      writer.write({writer.add_channel(schema, topic, "cdr"), sequence, time_ns, time_ns, data});
    };
    for (const std::string& imu : imus) add(imu, ros2::raw_imu(event(ImuSample{}, 1), 1, {}, {}));
    add("/fix", ros2::position_as_point({1, 2, 3}, 2, {}));
    writer.close();
    write_file(folder / (imus.size() == 1 ? "ros2" : "ros2_two_imus"), without_checksums(sink.content));
  }
}

}  // namespace

void write_mcap_corpus(const fs::path& folder) {
  write_mcap(folder);
  write_bus_recordings(folder);
  write_bags(folder);
}

}  // namespace sonopose::fuzz
