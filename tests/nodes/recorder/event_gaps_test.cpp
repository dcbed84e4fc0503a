#include "recorder/event_gaps.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace event_gaps_test {

using namespace sonopose;
using recorder::EventGaps;

constexpr std::uint16_t imu_channel = 1;
constexpr std::uint16_t fix_channel = 2;
constexpr std::uint16_t heading_channel = 3;
constexpr std::uint16_t pose_channel = 4;
constexpr std::uint16_t twist_channel = 5;

/// Start of a little-endian sample: address and event number.
std::vector<std::byte> sample_of(BeaconAddress address, std::uint64_t number) {
  std::vector<std::byte> bytes(4 + 16);
  bytes[1] = std::byte{1};
  for (std::size_t i = 0; i < 2; ++i) bytes[4 + i] = static_cast<std::byte>(address >> (8 * i));
  for (std::size_t i = 0; i < 8; ++i) bytes[12 + i] = static_cast<std::byte>(number >> (8 * i));
  return bytes;
}

struct Recording {
  EventGaps gaps;

  explicit Recording(std::uint16_t recorded_headings = heading_channel)
      : gaps({imu_channel, fix_channel, recorded_headings, twist_channel}) {}
  void on(std::uint64_t number, BeaconAddress address = 7, std::uint16_t channel_id = imu_channel) {
    const auto data = sample_of(address, number);
    mcap::Chunk chunk;
    chunk.add({channel_id, 1, 100, 100, data});
    gaps.on(chunk);
  }
  void on_range(std::uint64_t first, std::uint64_t last, BeaconAddress address = 7) {
    for (; first <= last; ++first) on(first, address);
  }
};

SCENARIO("missing events of the beacons are counted by their numbers") {
  Recording recording;
  GIVEN("a beacon whose events are recorded from number 500 on") {
    recording.on_range(500, 1000);
    THEN("what was before is not missing") {
      recording.gaps.finish();
      CHECK(recording.gaps.missing() == 0);
    }
    WHEN("1001 to 1090 do not arrive") {
      recording.on_range(1091, 2000);
      THEN("they are missing") {
        CHECK(recording.gaps.missing() == 90);
      }
      AND_WHEN("one of them arrives after all") {
        recording.on(1050);
        THEN("one fewer is") {
          CHECK(recording.gaps.missing() == 89);
        }
      }
    }
    WHEN("the recording ends soon after a gap") {
      recording.on_range(1091, 1100);
      recording.gaps.finish();
      THEN("it counts") {
        CHECK(recording.gaps.missing() == 90);
      }
    }
    WHEN("hours are missing") {
      recording.on_range(4'000'001, 4'000'400);
      THEN("they count") {
        CHECK(recording.gaps.missing() == 4'000'000 - 1000);
      }
    }
    WHEN("each event comes twice") {
      for (std::uint64_t number = 1001; number < 2000; ++number) {
        recording.on(number);
        recording.on(number, 7, fix_channel);
      }
      THEN("nothing is missing") {
        CHECK(recording.gaps.missing() == 0);
      }
    }
    WHEN("another beacon has its own numbers") {
      recording.on_range(1, 1000, 8);
      recording.on_range(1001, 2000);
      THEN("nothing is missing") {
        CHECK(recording.gaps.missing() == 0);
      }
    }
    WHEN("poses with some of the numbers are recorded") {
      for (std::uint64_t number = 5000; number < 9000; number += 10) recording.on(number, 7, pose_channel);
      THEN("nothing is missing") {
        CHECK(recording.gaps.missing() == 0);
      }
    }
  }
  GIVEN("three streams without an order between them") {
    std::vector<std::uint64_t> numbers(20'000);
    std::iota(numbers.begin(), numbers.end(), 1);
    std::mt19937 random(5);
    for (auto at = numbers.begin(); at + 100 <= numbers.end(); at += 100) {
      std::shuffle(at, at + 100, random);
    }
    for (const auto number : numbers) recording.on(number, 7, static_cast<std::uint16_t>(1 + number % 3));
    recording.gaps.finish();
    THEN("nothing is missing") {
      CHECK(recording.gaps.missing() == 0);
    }
  }
  GIVEN("a bridge that restarts after 5000 events") {
    recording.on_range(1, 5000);
    recording.on_range(3, 5000);  // the earlier ones precede the discovery
    THEN("nothing is missing") {
      CHECK(recording.gaps.missing() == 0);
    }
    WHEN("ten events of the second run do not arrive") {
      recording.on_range(5011, 6000);
      THEN("they are missing") {
        CHECK(recording.gaps.missing() == 10);
      }
    }
  }
  GIVEN("a bridge that restarts after 1000 events, ten of which did not arrive") {
    recording.on_range(1, 490);
    recording.on_range(501, 1000);
    REQUIRE(recording.gaps.missing() == 10);
    WHEN("ten others of the second run do not arrive") {
      recording.on_range(1, 600);
      recording.on_range(611, 1000);
      recording.gaps.finish();
      THEN("both losses count") {
        CHECK(recording.gaps.missing() == 20);
      }
    }
  }
  GIVEN("a fix that arrives before the first IMU samples of its beacon") {
    recording.on(10, 7, fix_channel);
    recording.on_range(1, 9);
    recording.on_range(11, 1000);
    recording.gaps.finish();
    THEN("nothing is missing") {
      CHECK(recording.gaps.missing() == 0);
    }
  }
  GIVEN("two bridges with the same beacon, one of them long before the other") {
    for (std::uint64_t number = 1; number < 3000; ++number) {
      recording.on(number);
      recording.on(100'000 + number);
    }
    THEN("nothing is missing") {
      CHECK(recording.gaps.missing() == 0);
    }
  }
  GIVEN("a number that no bridge has, from forged data") {
    recording.on_range(1, 3000);
    recording.on(~std::uint64_t{0});
    recording.on_range(3001, 6000);
    THEN("nothing is missing") {
      CHECK(recording.gaps.missing() == 0);
    }
  }
  GIVEN("a recording without the headings") {
    Recording without(0);
    without.on_range(1, 100);
    without.on_range(200, 1000);
    THEN("nothing is counted, since their numbers are missing anyway") {
      CHECK(without.gaps.missing() == 0);
    }
  }
}

}  // namespace event_gaps_test
