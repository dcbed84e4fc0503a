/// Protocols that are recognised in bytes without a beacon's frame.

#include "marvelmind/foreign_protocol.hpp"

#include "marvelmind/encoder.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace foreign_protocol_test {

using namespace sonopose::marvelmind;
using namespace std::string_literals;

std::string named(std::string_view bytes) {
  return foreign_protocol(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
}

SCENARIO("what arrives instead of a beacon's frames is named") {
  GIVEN("sentences of the NMEA 0183 standard, from the middle of one on") {
    // Examples with checksums from the documentation of gpsd and of receivers.
    const std::string sentences =
        "12.3,M,,*00\r\n$GPGLL,4916.45,N,12311.12,W,225444,A*31\r\n"
        "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"
        "$GPGLL,4916.45,N,12311.12,W,225444,A*31\r\n";
    THEN("each kind is listed once") {
      CHECK(named(sentences) == "NMEA sentences ($GPGLL, $GPGGA)");
    }
    THEN("with a wrong checksum they are only text") {
      CHECK(named("$GPGLL,4916.45,N,12311.12,W,225444,A*32\r\n") ==
            "text such as \"$GPGLL,4916.45,N,12311.12,W,225444,A*32\"");
    }
  }
  GIVEN("a message of u-blox's protocol: the acknowledgement of CFG-MSG, as in its manual") {
    THEN("it is named, wherever it begins") {
      CHECK(named("\x01\x02\xB5\x62\x05\x01\x02\x00\x06\x01\x0F\x38"s + "\x00"s) ==
            "messages of a u-blox receiver (UBX)");
    }
  }
  GIVEN("messages of RTCM 3: a reference station of type 1005, as in the standard") {
    THEN("they are named, wherever they begin") {
      CHECK(
          named("\x01\xD3\x00\x13\x3E\xD7\xD3\x02\x02\x98\x0E\xDE\xEF\x34\xB4\xBD\x62\xAC\x09\x41\x98\x6F\x33"
                "\x36\x0B\x98"s) == "corrections for a GNSS receiver (RTCM 3)");
    }
  }
  GIVEN("a block of Septentrio: the end of a position, with the CRC of CCITT over all after it") {
    const std::string block = "\x24\x40\x92\xF0\x21\x17\x10\x00\x00\x70\x99\x14\xBE\x08\x00\x00"s;
    THEN("it is named, wherever it begins, unless a bit is wrong") {
      CHECK(named("\x07" + block) == "messages of a Septentrio receiver (SBF)");
      std::string wrong = block;
      wrong[12] = '\x01';
      CHECK(named(wrong).empty());
    }
  }
  GIVEN("messages of Xsens: GoToMeasurement and GoToConfig, as in the manual") {
    THEN("two in a row are named") {
      CHECK(named("\xFA\xFF\x10\x00\xF1\xFA\xFF\x30\x00\xD1"s) == "messages of an Xsens IMU");
      CHECK(named("\xFA\xFF\x10\x00\xF1"s).empty());
    }
  }
  GIVEN("accelerations of WitMotion at rest, 1 g on z: 0x0800 of 16 g") {
    const std::string message = "\x55\x51\x00\x00\x00\x00\x00\x08\x00\x00\xAE"s;
    THEN("four in a row are named") {
      CHECK(named(message + message + message + message) == "messages of a WitMotion IMU");
      CHECK(named(message).empty());
    }
  }
  GIVEN("heartbeats of MAVLink 1 and 2, each with its size in the second byte") {
    const std::string one = "\xFE\x09\x01\x01\x01\x00\x00\x00\x00\x00\x02\x03\x51\x04\x03\x1C\x7F"s;
    const std::string two =
        "\xFD\x09\x00\x00\x01\x01\x01\x00\x00\x00\x00\x00\x00\x00\x02\x03\x51\x04\x03\x1C\x7F"s;
    const auto in_row = [](const std::string& message, std::size_t at_sequence, char step) {
      std::string all;
      for (char i = 0; i < 4; ++i) {
        all += message;
        all[all.size() - message.size() + at_sequence] = static_cast<char>(i * step);
      }
      return all;
    };
    THEN("four in a row are named, by their sequence numbers") {
      CHECK(named(in_row(one, 2, 1)) == "MAVLink messages");
      CHECK(named(in_row(two, 4, 1)) == "MAVLink messages");
      CHECK(named(one).empty());
      CHECK(named(in_row(one, 2, 0)).empty());  // as of rosserial, whose messages have an 0xFE too
    }
  }
  GIVEN("text") {
    THEN("a whole line of it is quoted, without control characters") {
      CHECK(named("lo world\r\nDebian GNU/Linux 12 robot\tttyS0\r\n\r\nrobot login: ") ==
            "text such as \"Debian GNU/Linux 12 robot ttyS0\"");
      CHECK(named("{\"x\": 1.25, \"y\": 3}") == "text such as \"{\"x\": 1.25, \"y\": 3}\"");
      const std::string coloured = named("robot \x1B[31m" + std::string(100, 'x') + " red");
      CHECK(coloured.starts_with("text such as \"robot "));
      CHECK(coloured.find('\x1B') == std::string::npos);
    }
  }
  GIVEN("the beginnings of files") {
    THEN("their kinds are named") {
      CHECK(named("\x89MCAP0\r\n\x01") == "an MCAP file");
      CHECK(named("\x1F\x8B\x08\x00"s) == "a compressed file (gzip)");
    }
  }
}

SCENARIO("noise and a beacon's own frames have no name") {
  CHECK(named("").empty());
  CHECK(named(std::string(1000, '\x55')).empty());  // alternating bits: a wrong baud rate
  CHECK(named(std::string(1000, '\0')).empty());
  std::mt19937 random(1);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int i = 0; i < 1000; ++i) {
    std::vector<std::uint8_t> noise(1024);
    for (std::uint8_t& each : noise) each = static_cast<std::uint8_t>(byte(random));
    REQUIRE(foreign_protocol(noise).empty());
  }
  const Frame frame = encode(Telemetry{.battery_mv = 3900, .rssi_dbm = -40, .address = 5});
  CHECK(foreign_protocol(frame.bytes()).empty());
}

}  // namespace foreign_protocol_test
