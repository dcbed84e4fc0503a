#include "ros2/relay/diagnostics.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

namespace diagnostics_test {

using namespace sonopose;
using namespace sonopose::ros2::relay;
using namespace sonopose::observation;
using ros2::Level;

constexpr TimeNs now_ns = 1'700'000'000'000'000'000;

ros2::Diagnostic diagnose(const BeaconView& view, const BeaconView& before) {
  return diagnostic_of("sonopose", view, before, now_ns);
}

BeaconView healthy() {
  BeaconView view;
  view.address = 7;
  view.window_s = 1;
  view.poses = 100;
  view.pose_rate_hz = 100;
  view.pose.trust = 1;
  view.bridge.emplace();
  view.bridge->battery_v = 3.9;
  view.bridge->time_ns = now_ns - 500'000'000;
  view.bridge->imu_rate_hz = 100;
  view.bridge->clock_offset_s = 12.5;
  view.fusion.emplace();
  return view;
}

std::string value_of(const ros2::Diagnostic& diagnostic, const std::string& key) {
  const auto found = std::find_if(diagnostic.values.begin(), diagnostic.values.end(),
                                  [&key](const auto& entry) { return entry.first == key; });
  return found == diagnostic.values.end() ? "(none)" : found->second;
}

bool says(const ros2::Diagnostic& diagnostic, const std::string& text) {
  return diagnostic.message.find(text) != std::string::npos;
}

SCENARIO("the diagnostic of a beacon") {
  GIVEN("a beacon that was healthy a second ago") {
    const BeaconView before = healthy();
    BeaconView now = healthy();
    WHEN("it still is healthy") {
      const auto diagnostic = diagnose(now, before);
      THEN("it is OK, and has name, rates, trust, battery and clock") {
        CHECK(diagnostic.level == Level::ok);
        CHECK(diagnostic.name == "sonopose: beacon 7");
        CHECK(diagnostic.hardware_id == "7");
        CHECK(value_of(diagnostic, "pose_rate_hz") == "100.0");
        CHECK(value_of(diagnostic, "imu_rate_hz") == "100.0");
        CHECK(value_of(diagnostic, "trust") == "1.000");
        CHECK(value_of(diagnostic, "battery_v") == "3.90");
        CHECK(value_of(diagnostic, "clock_offset_s") == "12.500000");
        CHECK(value_of(diagnostic, "bridge.imu_deadlines_missed") == "0");
        CHECK(value_of(diagnostic, "fusion.events_lost") == "0");
      }
    }
    WHEN("deadlines were missed and events lost long ago") {
      BeaconView earlier = before;
      earlier.bridge->imu_deadlines_missed = now.bridge->imu_deadlines_missed = 5;
      earlier.fusion->events_lost = now.fusion->events_lost = 3;
      THEN("it is OK") {
        CHECK(diagnose(now, earlier).level == Level::ok);
        CHECK(value_of(diagnose(now, earlier), "bridge.imu_deadlines_missed") == "5");
      }
    }
    WHEN("two more were missed in this second, and an event lost") {
      now.bridge->imu_deadlines_missed = 2;
      now.fusion->events_lost = 1;
      now.fusion->poses_unwritten = 3;
      const auto diagnostic = diagnose(now, before);
      THEN("this is a warning with all counts") {
        CHECK(diagnostic.level == Level::warning);
        CHECK(says(diagnostic, "bridge: 2 IMU deadlines missed"));
        CHECK(says(diagnostic, "fusion: 1 event lost"));
        CHECK(says(diagnostic, "fusion: 3 poses not written"));
      }
    }
    WHEN("its pose is stale or has low trust") {
      now.pose.status = status_stale | status_low_trust;
      THEN("this is a warning") {
        CHECK(diagnose(now, before).level == Level::warning);
        CHECK(says(diagnose(now, before), "stale"));
      }
    }
    WHEN("its fusion is overloaded, or its poses are late") {
      now.pose.status = status_overloaded | status_late;
      THEN("this is a warning") {
        CHECK(diagnose(now, before).level == Level::warning);
        CHECK(says(diagnose(now, before), "overloaded"));
        CHECK(says(diagnose(now, before), "late"));
      }
    }
    WHEN("its battery is low") {
      now.bridge->battery_v = 3.4;
      THEN("this is a warning") {
        CHECK(diagnose(now, before).level == Level::warning);
        CHECK(says(diagnose(now, before), "battery 3.40 V"));
      }
    }
    WHEN("several bridges publish it") {
      now.bridge->other_bridges = 1;
      THEN("this is an error, in the words of the monitor") {
        CHECK(diagnose(now, before).level == Level::error);
        CHECK(says(diagnose(now, before), "several bridges"));
      }
    }
    WHEN("its IMU is mounted upside down") {
      now.wrong_tilt_rad = 3.1;
      THEN("this is a warning, in the words of the monitor") {
        CHECK(diagnose(now, before).level == Level::warning);
        CHECK(says(diagnose(now, before), "IMU upside down"));
      }
    }
    WHEN("its IMU is silent") {
      now.fusion->imu_silent = true;
      now.poses = 0;  // a consequence
      THEN("this is an error") {
        CHECK(diagnose(now, before).level == Level::error);
      }
    }
    WHEN("the fusion is gone") {
      now.lost = true;
      now.poses = 0;
      THEN("this is an error") {
        CHECK(diagnose(now, before).level == Level::error);
      }
    }
    WHEN("there is no fusion at all") {
      now.fusion.reset();
      now.poses = 0;
      THEN("this is an error") {
        CHECK(diagnose(now, before).level == Level::error);
      }
    }
    WHEN("the fusion is gone, and the deadlines of its poses are missed") {
      now.lost = true;
      now.deadlines_missed = 10;
      THEN("the deadlines are not reported") {
        CHECK_FALSE(says(diagnose(now, before), "deadlines"));
      }
    }
    WHEN("its bridge has published no status for four seconds") {
      now.bridge->time_ns = now_ns - 4'000'000'000;
      THEN("this is an error, and old rates are omitted") {
        CHECK(diagnose(now, before).level == Level::error);
        CHECK(value_of(diagnose(now, before), "imu_rate_hz") == "(none)");
      }
    }
    WHEN("no pose arrived in the last second") {
      now.poses = 0;
      THEN("it is stale") {
        CHECK(diagnose(now, before).level == Level::stale);
      }
    }
  }
}

}  // namespace diagnostics_test
