#include "bus_log/sensor_log.hpp"

#include "bus_log/recorded.hpp"
#include "evaluation/replay/run.hpp"
#include "sim/simulator.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <utility>

namespace sonopose::sensor_log_test {

using Catch::Contains;
using sonopose::test::BusRecording;
using sonopose::test::TemporaryFolder;

sim::Recording walk(double duration_s) {
  return sim::record(sim::find_scenario("walk"), {.duration_s = duration_s});
}

std::uint64_t time_of(const Event& event) {
  return static_cast<std::uint64_t>(available_at_ns(event));
}

void write_all(BusRecording& recording, const std::vector<Event>& events) {
  for (const Event& event : events) recording.write(event, time_of(event));
}

SCENARIO("a recording of the bus is an input like a log folder") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  GIVEN("a minute of one beacon, recorded from its start, in either byte order") {
    const auto byte_order = GENERATE(std::endian::little, std::endian::big);
    const sim::Recording simulated = walk(60.0);
    {
      BusRecording recording(file, byte_order);
      write_all(recording, simulated.events);
      for (const TruthSample& truth : simulated.truth) {
        recording.write(dds::topics::truth, dds::topics::to_idl(truth),
                        static_cast<std::uint64_t>(truth.time_ns));
      }
    }
    const auto log = bus_log::read_sensor_log(file);
    THEN("it has the same events, to the bit") {
      CHECK(log.events == simulated.events);
      CHECK(log.truth == simulated.truth);
      CHECK(log.address == address_of(simulated.events.front()));
      CHECK(log.warnings.empty());
    }
    THEN("its replay has the same state hash") {
      recording::SensorLog direct;
      direct.events = simulated.events;
      direct.truth = simulated.truth;
      CHECK(evaluation::run(log, {}).state_hash == evaluation::run(direct, {}).state_hash);
    }
    THEN("its IMU samples are found alone") {
      const auto imu = bus_log::read_imu_log(file);
      CHECK(bus_log::read_attitude_log(file).imu == imu);
      CHECK(bus_log::read_attitude_log(file).truth.size() == simulated.truth.size());
      CHECK(imu.size() > 5000);
      CHECK(imu.front() == std::get<ImuSample>(simulated.events.front()));
    }
  }
  GIVEN("events that reached the recorder in another order than they were sent in") {
    auto events = walk(5.0).events;
    {
      BusRecording recording(file);
      auto arrived = events;
      for (std::size_t i = 0; i + 1 < arrived.size(); i += 2) std::swap(arrived[i], arrived[i + 1]);
      for (const Event& event : arrived) recording.write(event, time_of(events.front()) + 1);
    }
    THEN("they are in the order of their numbers, but the first, which was sent before the recording began") {
      const auto log = bus_log::read_sensor_log(file);
      REQUIRE(log.events.size() == events.size() - 1);
      CHECK(sequence_of(log.events.back()) == log.events.size());
      CHECK(available_at_ns(log.events.back()) == available_at_ns(events.back()));
    }
  }
  GIVEN("a recording with a lost event") {
    auto events = walk(5.0).events;
    events.erase(events.begin() + 100);
    {
      BusRecording recording(file);
      write_all(recording, events);
    }
    THEN("the loss is told, and what follows is read") {
      const auto log = bus_log::read_sensor_log(file);
      CHECK(log.events.size() == events.size());
      REQUIRE(log.warnings.size() == 1);
      CHECK_THAT(log.warnings[0], Contains("run.mcap: lacks 1 event of the bridge"));
    }
  }
}

SCENARIO("IMU stamps far ahead are left out of a recording of the bus as of a folder") {
  const TemporaryFolder folder;
  auto events = walk(20.0).events;
  std::size_t changed = 0;
  for (std::size_t i = 1000; changed < 2; ++i) {
    auto* const imu = std::get_if<ImuSample>(&events[i]);
    if (imu == nullptr) continue;
    imu->sensor_time_ns += 3'600'000'000'000;
    ++changed;
  }
  {
    BusRecording recording(folder / "run.mcap");
    for (const Event& event : events) recording.write(event, time_of(events.front()));
  }
  const auto log = bus_log::read_sensor_log(folder / "run.mcap");
  CHECK(log.events.size() == events.size() - 2);
  CHECK(sequence_of(log.events.back()) == log.events.size());
  REQUIRE(log.warnings.size() == 1);
  CHECK_THAT(log.warnings[0], Contains("run.mcap: 2 of ") && Contains(" IMU samples are left out") &&
                                  Contains("the first by 3600.0 s"));
}

SCENARIO("several files are one input") {
  const TemporaryFolder folder;
  GIVEN("a drive in three files of the recorder, and one whose topics are in files of their own") {
    const auto events = walk(6.0).events;
    std::filesystem::create_directories(folder / "drive");
    const std::vector<std::filesystem::path> parts{folder / "drive/run_9.mcap", folder / "drive/run_10.mcap",
                                                   folder / "drive/run_11.mcap"};
    for (std::size_t part = 0; part < parts.size(); ++part) {
      BusRecording recording(parts[part]);
      const std::size_t end = events.size() * (part + 1) / parts.size();
      for (std::size_t i = events.size() * part / parts.size(); i < end; ++i) {
        recording.write(events[i], time_of(events[i]));
      }
    }
    {
      BusRecording imu(folder / "imu.mcap");
      BusRecording others(folder / "others.mcap");
      for (const Event& event : events) {
        (std::holds_alternative<ImuSample>(event) ? imu : others).write(event, time_of(event));
      }
    }
    THEN("all events are read in their order, from the files and from the folder") {
      for (const auto& paths :
           {parts, std::vector{folder / "drive"}, std::vector{folder / "others.mcap", folder / "imu.mcap"}}) {
        const auto log = bus_log::read_sensor_log(paths);
        CHECK(log.events == events);
        CHECK(log.warnings.empty());
      }
      CHECK(bus_log::read_imu_log(folder / "drive").size() > 500);
    }
    THEN("a folder that is no such recording is named") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log({parts[0], folder.path() / "nowhere"}),
                        Contains("nowhere: does not exist"));
    }
  }
}

SCENARIO("the host's clock is set back during a recording") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  GIVEN("events whose log times go back by ten seconds in the middle, in chunks of a second") {
    const auto events = walk(20.0).events;
    {
      BusRecording recording(file);
      for (std::size_t i = 0; i < events.size(); ++i) {
        recording.write(events[i], time_of(events[i]) - (i < events.size() / 2 ? 0 : 10'000'000'000));
        if (i % 100 == 99) recording.writer().end_chunk();
      }
    }
    THEN("none is lost, and they are in the order of their numbers") {
      const auto log = bus_log::read_sensor_log(file);
      CHECK(log.events == events);
      CHECK(log.warnings.empty());
    }
  }
  GIVEN("log times at the end of what 64 bits can say") {
    const auto events = walk(2.0).events;
    {
      BusRecording recording(file);
      for (const Event& event : events) recording.write(event, ~std::uint64_t{0} - 5);
    }
    THEN("they are read") {
      CHECK(bus_log::read_sensor_log(file).events.size() == events.size());
    }
  }
}

SCENARIO("a replay warns of resets and changes of settings that it does not repeat") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  const auto events = walk(2.0).events;
  const std::uint64_t at = time_of(events.back());
  const BeaconAddress own = address_of(events.front());
  const auto settings = [&](BusRecording& recording, BeaconAddress address, const std::string& value) {
    const auto sample =
        dds::topics::to_idl(EffectiveSettings{.address = address,
                                              .time_ns = 5,
                                              .from_sequence = 1,
                                              .values = {{"heading.mount_offset_deg", value}}});
    recording.write(dds::topics::settings, sample.sample(), at);
  };
  GIVEN("resets of the beacon and of all, and two settings of it of which one is a change") {
    {
      BusRecording recording(file);
      write_all(recording, events);
      recording.write(dds::topics::reset, {.address = own, .request_id = 1}, at);
      recording.write(dds::topics::reset, {.address = all_beacons, .request_id = 2}, at);
      settings(recording, own, "0");
      settings(recording, own, "0");
      settings(recording, own, "90");
    }
    THEN("the warnings count them") {
      const auto log = bus_log::read_sensor_log(file);
      REQUIRE(log.warnings.size() == 2);
      CHECK_THAT(log.warnings[0], Contains("has 2 resets of the beacon"));
      CHECK_THAT(log.warnings[1], Contains("has 1 change of its settings"));
    }
  }
  GIVEN("those of another beacon") {
    {
      BusRecording recording(file);
      write_all(recording, events);
      const auto other = static_cast<BeaconAddress>(own + 1);
      recording.write(dds::topics::reset, {.address = other, .request_id = 1}, at);
      settings(recording, own, "0");
      settings(recording, other, "0");
      settings(recording, other, "90");
    }
    THEN("there is no warning") {
      CHECK(bus_log::read_sensor_log(file).warnings.empty());
    }
  }
}

SCENARIO("a recording is of another version of the IDL") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  const auto write_with = [&file](std::string schema) {
    BusRecording recording(file, std::endian::little, {}, std::move(schema));
    write_all(recording, walk(1.0).events);
  };
  const auto replaced = [](const std::string& from, const std::string& to) {
    std::string text = sonopose::test::idl_text();
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  GIVEN("another order of two fields of the IMU samples, which have the same size") {
    write_with(
        replaced("long long sensor_time;              // time of measurement\n    long long bridge_time;",
                 "long long bridge_time;\n    long long sensor_time;"));
    THEN("the error names the type") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file),
                        Contains("topic sonopose/imu has another type than sonopose::ImuSample"));
    }
  }
  GIVEN("another definition of a type that they use") {
    write_with(replaced("struct Vector3 { double x; double y; double z; };",
                        "struct Vector3 { double z; double y; double x; };"));
    THEN("the error names the type") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("has another type"));
    }
  }
  GIVEN("settings of another type beside its inputs") {
    {
      BusRecording recording(file);
      write_all(recording, walk(1.0).events);
      const auto schema =
          recording.writer().add_schema("sonopose::EffectiveSettings", "omgidl",
                                        "module sonopose { struct EffectiveSettings { long a; }; };");
      const auto channel = recording.writer().add_channel(schema, "sonopose/settings", "cdr");
      recording.writer().write({channel, 1, 99, 99, std::vector<std::byte>(12)});
    }
    THEN("the inputs are read, with a warning") {
      const auto log = bus_log::read_sensor_log(file);
      CHECK(log.events.size() == walk(1.0).events.size());
      REQUIRE(log.warnings.size() == 1);
      CHECK_THAT(log.warnings.front(), Contains("topic sonopose/settings has another type") &&
                                           Contains("not known whether they changed"));
    }
  }
  GIVEN("other comments, other spaces, and more types") {
    write_with(replaced("// time of measurement", "/* another\n text */") +
               "\nmodule more { struct Other { long a; }; };");
    THEN("it is read") {
      CHECK_FALSE(bus_log::read_sensor_log(file).events.empty());
    }
  }
  GIVEN("samples with more bytes than the type") {
    {
      BusRecording recording(file);
      const auto schema = recording.writer().add_schema("sonopose::ImuSample", "omgidl", "");
      const auto channel = recording.writer().add_channel(schema, "sonopose/imu", "cdr");
      auto data = dds::write_cdr(dds::topics::to_idl(std::get<ImuSample>(walk(1.0).events.front())));
      data.resize(data.size() + 8);
      recording.writer().write({channel, 1, 99, 99, data});
    }
    THEN("the error names the message") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("message 1 of sonopose/imu"));
    }
  }
}

SCENARIO("a recording has several beacons") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  {
    BusRecording recording(file);
    for (Event event : walk(2.0).events) {
      for (const BeaconAddress address : {BeaconAddress{12}, BeaconAddress{300}}) {
        std::visit([address](auto& sample) { sample.address = address; }, event);
        recording.write(event, time_of(event));
      }
    }
  }
  GIVEN("no address") {
    THEN("the error lists them") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file),
                        Contains("run.mcap: has 2 beacons; choose one with --beacon: 12, 300"));
    }
  }
  GIVEN("one of them") {
    THEN("its events are read") {
      const auto log = bus_log::read_sensor_log(file, BeaconAddress{300});
      CHECK(log.address == 300);
      CHECK(log.events.size() == walk(2.0).events.size());
      CHECK(address_of(log.events.back()) == 300);
    }
  }
  GIVEN("another one") {
    THEN("the error lists those that it has") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file, BeaconAddress{7}),
                        Contains("has no beacon 7; it has 12, 300"));
    }
  }
}

SCENARIO("a file that is no such recording") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  GIVEN("no messages of the inputs") {
    {
      BusRecording recording(file);
      recording.write(dds::topics::reset, {.address = 7, .request_id = 1}, 5);
    }
    THEN("the error says so") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("run.mcap: has no message of the topics"));
    }
  }
  GIVEN("a message that is no sample") {
    {
      BusRecording recording(file);
      const auto channel = recording.writer().add_channel(0, "sonopose/imu", "cdr");
      const std::vector<std::byte> data{std::byte{0}, std::byte{1}, std::byte{0},
                                        std::byte{0}, std::byte{7}, std::byte{0}};
      recording.writer().write({channel, 3, 99, 99, data});
    }
    THEN("the error names it") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file),
                        Contains("message 3 of sonopose/imu at log time 99 is not a serialized sample"));
    }
  }
  GIVEN("a topic of ours in another encoding") {
    {
      BusRecording recording(file);
      recording.writer().add_channel(0, "sonopose/imu", "json");
    }
    THEN("the error names both encodings") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file),
                        Contains("topic sonopose/imu has message encoding \"json\" instead of \"cdr\""));
    }
  }
  GIVEN("a sample whose time is far beyond a recording") {
    {
      BusRecording recording(file);
      ImuSample sample;
      sample.sensor_time_ns = -5;
      recording.write(Event(sample), 5);
    }
    THEN("the error names it") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("has the time -5, which is not between 1"));
    }
  }
}

}  // namespace sonopose::sensor_log_test
