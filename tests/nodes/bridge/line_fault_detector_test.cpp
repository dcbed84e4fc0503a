#include "bridge/line_fault_detector.hpp"

#include <catch2/catch.hpp>

#include <cstdint>
#include <string_view>
#include <vector>

namespace line_fault_detector_test {

using namespace sonopose;
using bridge::LineFaultDetector;
using Catch::Contains;

constexpr TimeNs tenth_ns = 100'000'000;

/// A line that was opened a moment ago.
class Line {
public:
  Line() {
    status_.name = "/dev/ttyACM0";
    status_.state = LineState::open;
    pass(0.1, 0, 0);
  }

  /// Status after `duration_s` with these bytes and frames every 100 ms.
  LineStatus pass(double duration_s, std::uint64_t bytes, std::uint64_t frames) {
    LineStatus judged;
    for (const SteadyTime end = now_ + to_ns(duration_s); now_ < end; now_ += tenth_ns) {
      status_.bytes += bytes;
      status_.frames += frames;
      judged = status_;
      detector_.judge(judged, now_);
    }
    return judged;
  }

  void set(LineState state) { status_.state = state; }
  void receive(std::string_view bytes) {
    detector_.on_bytes(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  }

private:
  LineFaultDetector detector_{{"check --baud (now 9600)", "set the protocol to Marvelmind"}};
  LineStatus status_;
  SteadyTime now_{1'000'000'000};
};

SCENARIO("a line that is open and delivers no frames is reported") {
  GIVEN("an open line") {
    Line line;
    WHEN("frames arrive") {
      THEN("it is open, without a text") {
        const LineStatus now = line.pass(10.0, 100, 3);
        CHECK(now.state == LineState::open);
        CHECK(now.text.empty());
      }
    }
    WHEN("bytes arrive without a frame") {
      THEN("it is reported within 5 s, with the bytes and what to check") {
        CHECK(line.pass(2.0, 100, 0).state == LineState::open);
        const LineStatus now = line.pass(3.0, 100, 0);
        CHECK(now.state == LineState::no_frames);
        CHECK_THAT(now.text, Contains("5000 bytes without a valid frame") && Contains("--baud (now 9600)"));
        AND_WHEN("frames follow") {
          THEN("it is open again") {
            CHECK(line.pass(1.0, 100, 3).state == LineState::open);
          }
        }
      }
    }
    WHEN("a GPS receiver's sentences arrive") {
      for (int i = 0; i < 50; ++i) line.receive("$GPGLL,4916.45,N,12311.12,W,225444,A*31\r\n");
      THEN("they are named, with the setting to change instead of the baud rate") {
        CHECK_THAT(line.pass(5.0, 100, 0).text,
                   Contains("without a valid frame: they are NMEA sentences ($GPGLL)") &&
                       Contains("set the protocol to Marvelmind") && !Contains("--baud"));
      }
    }
    WHEN("noise has arrived by the time at which its opening is seen, and then nothing") {
      line.set(LineState::waiting);
      line.pass(1.0, 0, 0);
      line.set(LineState::open);
      line.pass(0.1, 1000, 0);
      THEN("the noise is reported") {
        CHECK(line.pass(4.0, 0, 0).state == LineState::no_frames);
      }
    }
    WHEN("nothing arrives") {
      THEN("it is silent within 5 s") {
        const LineStatus now = line.pass(5.0, 0, 0);
        CHECK(now.state == LineState::silent);
        CHECK_THAT(now.text, Contains("no bytes for 5 s"));
      }
    }
    WHEN("frames stop in the middle of one") {
      line.pass(10.0, 100, 3);
      line.pass(0.1, 40, 0);
      THEN("it is silent, rather than without frames") {
        CHECK(line.pass(5.0, 0, 0).state == LineState::silent);
      }
    }
    WHEN("the baud rate changes after good frames") {
      line.pass(10.0, 100, 3);
      THEN("it is without frames") {
        CHECK(line.pass(5.0, 100, 0).state == LineState::no_frames);
      }
    }
    WHEN("the device is unplugged for a minute and returns") {
      line.set(LineState::waiting);
      CHECK(line.pass(60.0, 0, 0).state == LineState::waiting);
      line.set(LineState::open);
      THEN("it has time to send") {
        CHECK(line.pass(2.0, 0, 0).state == LineState::open);
      }
    }
  }
}

}  // namespace line_fault_detector_test
