/// ROS 2 messages of any type as JSON, by the text of their definitions.

#include "ros2/bag/message_definition.hpp"

#include "bus_log/messages.hpp"
#include "ros2/bag/drives.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <string>

namespace message_definition_test {

using namespace sonopose;
using Catch::Contains;
using ros2::bag::MessageDefinition;

std::vector<std::byte> bytes_of(const std::vector<int>& values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

std::string json_of(const std::string& text, const std::vector<int>& cdr) {
  const auto definition = MessageDefinition::parse("demo_msgs/msg/Demo", text);
  REQUIRE(definition);
  return definition->json_of(bytes_of(cdr));
}

SCENARIO("a message is read by its definition") {
  GIVEN("constants, defaults, comments and every repetition") {
    const std::string text =
        "# a comment\n"
        "uint8 LIMIT=3  # a constant\n"
        "string WORD = \"a # b\"\n"
        "\n"
        "int16 a 5   # with a default\n"
        "bool[2] flags\n"
        "float32[] values\n"
        "string<=8[<=2] names\r\n"
        "Part part\n"
        "other_msgs/Empty[2] empty\n"
        "================================================================================\n"
        "MSG: demo_msgs/Part\n"
        "int64 big\n"
        "builtin_interfaces/msg/Time stamp\n"
        "================\n"
        "MSG: other_msgs/Empty\n"
        "uint8 ONLY=1\n"
        "================\n"
        "MSG: builtin_interfaces/Time\n"
        "int32 sec\n"
        "uint32 nanosec\n";
    // XCDR1, little endian. Alignment counts from behind the header of 4 bytes.
    const std::vector<int> cdr{0,    1,    0,    0,                             //
                               0xfe, 0xff, 1,    0,                             // a, flags
                               1,    0,    0,    0,    0,    0,    0xc0, 0x3f,  // values: 1.5
                               2,    0,    0,    0,                             // names: 2
                               3,    0,    0,    0,    'u',  'p',  0,    0,     // "up"
                               2,    0,    0,    0,    '"',  0,    0,    0,     // "\""
                               0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f,  //
                               5,    0,    0,    0,    6,    0,    0,    0,     // stamp
                               0,    0};                                        // the hidden members
    THEN("its JSON has the fields in their order") {
      CHECK(json_of(text, cdr) ==
            R"({"a":-2,"flags":[true,false],"values":[1.5],"names":["up","\""],)"
            R"("part":{"big":9223372036854775807,"stamp":{"sec":5,"nanosec":6}},"empty":[{},{}]})");
    }
    THEN("no cut or longer message is read") {
      for (std::size_t size = 0; size < cdr.size(); ++size) {
        CAPTURE(size);
        CHECK(json_of(text, {cdr.begin(), cdr.begin() + static_cast<std::ptrdiff_t>(size)}).empty());
      }
      auto longer = cdr;
      longer.resize(cdr.size() + 4);
      CHECK(json_of(text, longer).empty());
    }
  }
  GIVEN("big endian") {
    THEN("it is read") {
      CHECK(json_of("uint32 a\nfloat64 b", {0, 0, 0,    0,    0, 0, 1, 2, 0, 0,
                                            0, 0, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0}) == R"({"a":258,"b":1.5})");
    }
  }
  GIVEN("lengths beyond the message") {
    THEN("it is not read, at once") {
      CHECK(json_of("float64[] a", {0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff}).empty());
      CHECK(json_of("uint8[4000000000] a", {0, 1, 0, 0, 1, 2, 3, 4}).empty());
      CHECK(json_of("string a", {0, 1, 0, 0, 0xff, 0xff, 0xff, 0x7f, 'a', 0}).empty());
      CHECK(json_of("Demo a", {0, 1, 0, 0, 1}).empty());  // has itself
    }
  }
}

SCENARIO("definitions that cannot be used") {
  GIVEN("missing parts, strings of wide characters, arrays without elements, other texts") {
    THEN("there is no definition") {
      for (const char* const text : {"other_msgs/Missing a", "wstring a", "uint8[0] a", "uint8[x] a",
                                     "uint8[3 a", "struct Demo {", "int32", "int32 a\n====\nno part"}) {
        CAPTURE(text);
        CHECK_FALSE(MessageDefinition::parse("demo_msgs/msg/Demo", text));
      }
    }
  }
}

SCENARIO("messages of a recording of ROS 2 are written as JSON") {
  const test::TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  GIVEN("samples of an IMU with their definition") {
    const auto events = test::walk_events(0.1);
    test::write_bag(file, {test::imu_message(std::get<ImuSample>(events.front()))});
    THEN("their fields have the names and values of ROS 2") {
      const mcap::Reader reader(file);
      bus_log::ChosenMessages messages(reader, {});
      const auto chosen = messages.next();
      REQUIRE(chosen);
      bus_log::MessageLines lines(reader);
      const auto line = nlohmann::json::parse(lines.line_of(*chosen->channel, chosen->message));
      const auto& imu = std::get<ImuSample>(events.front());
      CHECK(line["topic"] == "/imu/data");
      CHECK(line["message"]["header"]["frame_id"] == "imu_link");
      CHECK(line["message"]["linear_acceleration"]["z"] == imu.specific_force_body_mps2.z());
      CHECK(line["message"]["orientation_covariance"][0] == -1.0);
      CHECK(line["message"]["orientation_covariance"].size() == 9);
    }
  }
  GIVEN("the same without a definition") {
    const auto events = test::walk_events(0.1);
    test::write_bag(file, {test::imu_message(std::get<ImuSample>(events.front()))},
                    {.has_definitions = false});
    THEN("they are in hexadecimal digits") {
      const mcap::Reader reader(file);
      bus_log::ChosenMessages messages(reader, {});
      const auto chosen = messages.next();
      bus_log::MessageLines lines(reader);
      CHECK_THAT(lines.line_of(*chosen->channel, chosen->message), Contains(R"("data":"00010000)"));
    }
  }
}

}  // namespace message_definition_test
