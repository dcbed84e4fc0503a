#include "recording/log_folder.hpp"

#include "recording/merge.hpp"
#include "recording/samples_at.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace log_folder_test {

using namespace sonopose;
using namespace sonopose::recording;
using sonopose::test::fix_at;
using sonopose::test::heading_at;
using sonopose::test::imu_at;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

const std::string imu_header = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
const std::string fix_header = "#timestamp [ns],received [ns],x [m],y [m],z [m],quality [%]\n";
const std::string heading_header = "#timestamp [ns],received [ns],heading [deg]\n";

/// Kinds and times of the events, such as "I100 F100 H120".
std::string order_of(const std::vector<Event>& events) {
  std::string text;
  for (const Event& event : events) {
    if (!text.empty()) text += ' ';
    text += "IFH"[event.index()];
    text += std::to_string(available_at_ns(event));
  }
  return text;
}

std::vector<Event> merged(const std::vector<ImuSample>& imu, const std::vector<UltrasonicFix>& fixes,
                          const std::vector<PairHeading>& headings) {
  return merge_by_availability("log", imu, fixes, headings).events;
}

bool all_nan(const Vector3d& v) {
  return std::isnan(v.x()) && std::isnan(v.y()) && std::isnan(v.z());
}

SCENARIO("a log's rows become SI samples") {
  GIVEN("a log with a magnetometer, an unknown quality and an unknown heading") {
    const TemporaryFolder log;
    write_text(log / "imu.csv",
               "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z,m_x [uT],m_y [uT],m_z [uT]\n"
               "1700000000123456789,0.1,-0.2,3e-1,0,+1.5, 9.81 ,20,-3,-42.5\n"
               "1700000000133456789,0,0,0,0,0,9.81,,,\n");
    write_text(log / "ultrasonic.csv", fix_header +
                                           "1700000000000000000,1700000000068000000,1.5,-2,0.25,87\n"
                                           "1700000000100000000,1700000000200000000,1,2,3,\n");
    write_text(log / "heading.csv", heading_header +
                                        "1700000000000000000,1700000000068000000,-90\n"
                                        "1700000000100000000,1700000000200000000,\n");
    write_text(log / "truth.csv",
               "#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,b_w_x,b_w_y,b_w_z,b_a_x,b_a_y,b_a_z\n"
               "5,1,2,3,0.5,0.5,-0.5,0.5,7,8,9,,,,,,\n"
               "6,,,,1,0,0,0\n"
               "7,1,2,3,,,,,,,\n");
    write_text(log / "wheel_speed.csv", "#timestamp [ns],speed [m s^-1]\n9,-1.5\n8,0.25\n");
    WHEN("it is read") {
      const SensorLog read = read_sensor_log(log.path());
      THEN("the events are in the order of receipt, numbered from 1") {
        CHECK(order_of(read.events) ==
              "F1700000000068000000 H1700000000068000000 I1700000000123456789 I1700000000133456789 "
              "F1700000000200000000 H1700000000200000000");
        for (std::size_t i = 0; i < read.events.size(); ++i) {
          CHECK(sequence_of(read.events[i]) == i + 1);
          CHECK(address_of(read.events[i]) == 7);
        }
      }
      THEN("the IMU is in rad/s, m/s² and tesla") {
        const auto& imu = std::get<ImuSample>(read.events[2]);
        CHECK(imu.sensor_time_ns == 1'700'000'000'123'456'789);
        CHECK(imu.angular_velocity_body_radps == Vector3d(0.1, -0.2, 0.3));
        CHECK(imu.specific_force_body_mps2 == Vector3d(0, 1.5, 9.81));
        REQUIRE(imu.magnetic_field_body_t.has_value());
        CHECK((*imu.magnetic_field_body_t - Vector3d(20e-6, -3e-6, -42.5e-6)).norm() < 1e-20);
        CHECK_FALSE(std::get<ImuSample>(read.events[3]).magnetic_field_body_t.has_value());
      }
      THEN("the speeds of the wheels are in ascending time, backwards is negative") {
        REQUIRE(read.wheel_speeds.size() == 2);
        CHECK(read.wheel_speeds[0].time_ns == 8);
        CHECK(read.wheel_speeds[0].speed_mps == 0.25);
        CHECK(read.wheel_speeds[1].speed_mps == -1.5);
      }
      THEN("a fix has its delay, and no quality where the cell is empty") {
        const auto& fix = std::get<UltrasonicFix>(read.events[0]);
        CHECK(fix.position_world_m == Vector3d(1.5, -2, 0.25));
        CHECK(fix.quality_percent == 87.0);
        CHECK(fix.emission_time_ns == 1'700'000'000'000'000'000);
        CHECK(*fix.measured_delay_s == Approx(0.068));
        CHECK_FALSE(std::get<UltrasonicFix>(read.events[4]).quality_percent.has_value());
      }
      THEN("a heading is in radians, and not valid where the cell is empty") {
        const auto& heading = std::get<PairHeading>(read.events[1]);
        CHECK(heading.valid);
        CHECK(heading.heading_world_rad == Approx(-std::numbers::pi / 2));
        CHECK_FALSE(std::get<PairHeading>(read.events[5]).valid);
      }
      THEN("truth has NaN where a cell is empty or missing") {
        REQUIRE(read.truth.size() == 3);
        CHECK(read.truth[0].time_ns == 5);
        CHECK(read.truth[0].position_world_m == Vector3d(1, 2, 3));
        CHECK(read.truth[0].q_body_to_world.coeffs() == Eigen::Vector4d(0.5, -0.5, 0.5, 0.5));
        CHECK(read.truth[0].velocity_world_mps == Vector3d(7, 8, 9));
        CHECK(all_nan(read.truth[1].position_world_m));
        CHECK(read.truth[1].q_body_to_world.w() == 1.0);
        CHECK(all_nan(read.truth[1].velocity_world_mps));
        CHECK(std::isnan(read.truth[2].q_body_to_world.w()));
      }
    }
    WHEN("it is read for another beacon") {
      const SensorLog read = read_sensor_log(log.path(), 21);
      THEN("every sample is that beacon's") {
        for (const Event& event : read.events) CHECK(address_of(event) == 21);
        for (const TruthSample& sample : read.truth) CHECK(sample.address == 21);
      }
    }
  }
}

/// The only event of a log with this file.
Event event_of(const std::string& name, const std::string& text) {
  const TemporaryFolder log;
  write_text(log / "imu.csv", imu_header);
  write_text(log / "ultrasonic.csv", fix_header);
  write_text(log / name.c_str(), text);
  const std::vector<Event> events = read_sensor_log(log.path()).events;
  REQUIRE(events.size() == 1);
  return events.front();
}

SCENARIO("columns are found by their names, in any order and unit") {
  GIVEN("an IMU in the order and the units of others") {
    const auto text = GENERATE(
        as<std::string>(),
        "#timestamp [us],a_x [g],a_y [g],a_z [g],w_x [deg s^-1],w_y [deg s^-1],w_z [deg s^-1]\n"
        "1700000000500000,0,0.5,1,90,-180,0\n",
        "time (s); gyro_z (deg/s); gyro_y (deg/s); gyro_x (deg/s); acc_z (g); acc_y (g); acc_x (g)\n"
        "1700000000.5; 0; -180; 90; 1; 0.5; 0\n",
        "# a comment\n#t_ms,gx_dps,gy_dps,gz_dps,ax_mg,ay_mg,az_mg,temperature [C]\n"
        "1700000000500,90,-180,0,0,500,1000,21\n",
        "# of a robot\n\"timestamp (milliseconds)\"\t\"gx (degrees/second)\"\t\"gy (degrees/second)\"\t"
        "\"gz (degrees/second)\"\tax_g\tay_g\taz_g\n#first\n1700000000500\t90\t-180\t0\t0\t0.5\t1\n",
        "#timestamp [ns],w_RS_S_x [deg/s],w_RS_S_y [deg/s],w_RS_S_z [deg/s],a_RS_S_x [mg],a_RS_S_y [mg],"
        "a_RS_S_z [mg]\n1.7000000005e18,90,-180,0,0,500,1000\n");
    THEN("the sample is the same") {
      const auto imu = std::get<ImuSample>(event_of("imu.csv", text));
      CHECK(imu.sensor_time_ns == 1'700'000'000'500'000'000);
      CHECK(imu.angular_velocity_body_radps.isApprox(Vector3d(std::numbers::pi / 2, -std::numbers::pi, 0)));
      CHECK(imu.specific_force_body_mps2.isApprox(Vector3d(0, 0.5, 1) * standard_gravity_mps2));
    }
  }
  GIVEN("a magnetometer in gauss") {
    const auto imu =
        std::get<ImuSample>(event_of("imu.csv",
                                     "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z,mag_x [G],mag_y [G],mag_z [G]\n"
                                     "5,0,0,0,0,0,9.8,0.2,0,-0.4\n"));
    THEN("it is in tesla") {
      CHECK(imu.magnetic_field_body_t->isApprox(Vector3d(20e-6, 0, -40e-6)));
    }
  }
  GIVEN("fixes in millimetres, y before x, without a quality") {
    const auto fix =
        std::get<UltrasonicFix>(event_of("ultrasonic.csv",
                                         "#timestamp [ms],received [ms],y [mm],x [mm],z "
                                         "[mm]\n1700000000000.25,1700000000068,2000,1500,-250\n"));
    THEN("they are in metres, x first") {
      CHECK(fix.position_world_m.isApprox(Vector3d(1.5, 2, -0.25)));
      CHECK(fix.emission_time_ns == 1'700'000'000'000'250'000);
      CHECK_FALSE(fix.quality_percent.has_value());
    }
  }
  GIVEN("a heading in radians") {
    const auto heading = std::get<PairHeading>(
        event_of("heading.csv", "#timestamp [ns],received [ns],heading [rad]\n1,2,-0.5\n"));
    THEN("it is that") {
      CHECK(heading.heading_world_rad == Approx(-0.5));
    }
  }
  GIVEN("velocities in km/h, with a deviation in mm/s") {
    const auto twist = std::get<TwistSample>(event_of("twist.csv",
                                                      "#timestamp [ns],received [ns],v_x [km h^-1],v_y [km "
                                                      "h^-1],v_z [km h^-1],std_x [mm s^-1]\n1,2,36,,,50\n"));
    THEN("they are in m/s") {
      CHECK(twist.velocity_body_mps.x() == Approx(10));
      CHECK(twist.velocity_std_mps.x() == Approx(0.05));
      CHECK(twist.axes == twist_velocity_x);
    }
  }
}

SCENARIO("truth is read as others write it") {
  const TemporaryFolder log;
  const auto truth_of = [&log](const std::string& text) {
    write_text(log / "truth.csv", text);
    return read_truth_csv(log / "truth.csv", 7);
  };
  GIVEN("positions only") {
    const auto truth = truth_of("#timestamp [ns],p_x [m],p_y [m],p_z [m]\n5,1,2,3\n");
    THEN("attitude and velocity are unknown") {
      REQUIRE(truth.size() == 1);
      CHECK(truth[0].position_world_m == Vector3d(1, 2, 3));
      CHECK(std::isnan(truth[0].q_body_to_world.w()));
      CHECK(all_nan(truth[0].velocity_world_mps));
    }
  }
  GIVEN("a trajectory of TUM: seconds, separated by spaces, the real part last") {
    const auto truth = truth_of(
        "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n1700000000.123456789 1 2  3 0 0 1 0\n");
    THEN("it is the same body") {
      REQUIRE(truth.size() == 1);
      CHECK(truth[0].time_ns == 1'700'000'000'123'456'789);
      CHECK(truth[0].position_world_m == Vector3d(1, 2, 3));
      CHECK(truth[0].q_body_to_world.z() == 1.0);
      CHECK(truth[0].q_body_to_world.w() == 0.0);
    }
  }
  GIVEN("samples out of order") {
    write_text(log / "truth.csv",
               "#timestamp [s] tx [m] ty [m] tz [m]\n7 0 0 0\n9 1 0 0\n8 2 0 0\n8.5 3 0 0\n10 4 0 0\n");
    write_text(log / "imu.csv", "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n");
    write_text(log / "ultrasonic.csv", fix_header);
    const auto read = read_sensor_log(log.path());
    THEN("they are sorted by time, and those behind are counted") {
      REQUIRE(read.truth.size() == 5);
      CHECK(read.truth[1].position_world_m.x() == 2.0);
      REQUIRE(read.warnings.size() == 1);
      CHECK_THAT(read.warnings[0], Catch::Contains("2 of 5 true poses are stamped earlier than one before "
                                                   "them, in 1 step back, the first by 1.000 s"));
    }
  }
  GIVEN("EuRoC's names") {
    const auto truth = truth_of(
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
        "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad "
        "s^-1], "
        "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n"
        "5,1,2,3,0,1,0,0,4,5,6,0.1,0.2,0.3,7,8,9\n");
    THEN("position, attitude and velocity are read") {
      REQUIRE(truth.size() == 1);
      CHECK(truth[0].q_body_to_world.x() == 1.0);
      CHECK(truth[0].velocity_world_mps == Vector3d(4, 5, 6));
    }
  }
}

SCENARIO("streams are merged by availability, and no file's order is changed") {
  GIVEN("all three at the same time") {
    THEN("IMU comes first, then fix, then heading") {
      CHECK(order_of(merged({imu_at(5), imu_at(5)}, {fix_at(5)}, {heading_at(5)})) == "I5 I5 F5 H5");
    }
  }
  GIVEN("a fix whose clock went back") {
    THEN("it stays behind the fix before it, and before what comes later in its own file") {
      CHECK(order_of(merged({imu_at(1), imu_at(2), imu_at(3), imu_at(4)}, {fix_at(3), fix_at(1), fix_at(4)},
                            {})) == "I1 I2 I3 F3 F1 I4 F4");
    }
  }
  GIVEN("an IMU that stamps several samples alike, and once goes back") {
    THEN("every sample stays, in order") {
      CHECK(order_of(merged({imu_at(10), imu_at(10), imu_at(9), imu_at(20)}, {fix_at(9)},
                            {heading_at(10)})) == "F9 I10 I10 I9 H10 I20");
    }
  }
  GIVEN("IMU stamps that are far ahead of those around them") {
    const TimeNs far = 1'000'000'000'000;
    THEN("they are left out and delay no fix") {
      CHECK(order_of(merged({imu_at(10), imu_at(far), imu_at(30), imu_at(40)}, {fix_at(15), fix_at(35)},
                            {heading_at(45)})) == "I10 F15 I30 F35 I40 H45");
      CHECK(order_of(merged({imu_at(far), imu_at(20), imu_at(30)}, {fix_at(15), fix_at(25)}, {})) ==
            "F15 I20 F25 I30");
      CHECK(order_of(merged({imu_at(10), imu_at(far), imu_at(2 * far), imu_at(30), imu_at(40)},
                            {fix_at(15), fix_at(35)}, {})) == "I10 F15 I30 F35 I40");
    }
    THEN("they are counted") {
      const auto log = merge_by_availability(
          "log", {imu_at(far), imu_at(20), imu_at(far), imu_at(30), imu_at(40)}, {}, {});
      CHECK(log.warnings == std::vector<std::string>{
                                "log: 2 of 5 IMU samples are left out: stamped ahead of those that follow, "
                                "the first by 1000.0 s"});
    }
  }
  GIVEN("fifty stamps in a row that are an hour ahead") {
    std::vector<ImuSample> imu;
    for (int i = 0; i < 500; ++i) {
      const bool is_wrong = i >= 200 && i < 250;
      imu.push_back(imu_at(1 + i * 10'000'000LL + (is_wrong ? 3'600'000'000'000 : 0)));
    }
    THEN("they alone are left out") {
      CHECK(merged(imu, {}, {}).size() == 450);
    }
  }
  GIVEN("stamps that are ahead by a second and a half, or by two") {
    const auto left_out = [](int count, TimeNs ahead_ns, TimeNs interval_ns = 10'000'000) {
      std::vector<ImuSample> imu;
      for (int i = 0; i < 500; ++i) {
        const bool is_wrong = i >= 200 && i < 200 + count;
        imu.push_back(imu_at(1 + i * interval_ns + (is_wrong ? ahead_ns : 0)));
      }
      return 500 - static_cast<int>(merged(imu, {}, {}).size());
    };
    THEN("up to 63 of them are left out") {
      CHECK(left_out(1, 1'500'000'000) == 1);
      CHECK(left_out(63, 2'000'000'000) == 63);
      CHECK(left_out(64, 2'000'000'000) == 0);
      CHECK(left_out(1, 900'000'000) == 0);
      CHECK(left_out(1, 1'500'000'000, 100'000'000) == 1);
    }
  }
  GIVEN("an IMU whose clock is set back by an hour, and one whose rows are in reverse order") {
    std::vector<ImuSample> set_back;
    for (int i = 0; i < 500; ++i) {
      set_back.push_back(imu_at(1 + i * 10'000'000LL + (i < 250 ? 3'600'000'000'000 : 0)));
    }
    std::vector<ImuSample> reversed;
    for (int i = 500; i > 0; --i) reversed.push_back(imu_at(i * 40'000'000LL));
    THEN("no sample is left out") {
      CHECK(merged(set_back, {}, {}).size() == 500);
      CHECK(merged(reversed, {}, {}).size() == 500);
    }
  }
  GIVEN("an IMU stamp that is far behind those around it") {
    const TimeNs now = 1'000'000'000'000;
    THEN("no sample before it comes earlier than its time") {
      CHECK(order_of(merged({imu_at(now), imu_at(now + 10), imu_at(5), imu_at(now + 20)},
                            {fix_at(now + 5), fix_at(now + 15)}, {})) ==
            "I1000000000000 F1000000000005 I1000000000010 I5 F1000000000015 I1000000000020");
    }
  }
  GIVEN("an IMU that was silent for seconds, and sends its samples out of order") {
    const TimeNs later = 5'000'000'000;
    THEN("the first sample after the silence is merged at its time") {
      CHECK(order_of(merged({imu_at(10), imu_at(later + 20), imu_at(later + 10)},
                            {fix_at(15), fix_at(later + 15)}, {})) ==
            "I10 F15 F5000000015 I5000000020 I5000000010");
    }
  }
  GIVEN("a clock that is set back by 100 s, which IMU, fixes and headings show") {
    constexpr TimeNs ms = 1'000'000;
    constexpr TimeNs begin_ns = 1'000'000 * ms;
    std::vector<ImuSample> imu;
    std::vector<UltrasonicFix> fixes;
    std::vector<PairHeading> headings;
    std::string expected;
    const auto expect = [&expected](char kind, TimeNs time_ns) {
      if (!expected.empty()) expected += ' ';
      expected += kind + std::to_string(time_ns);
    };
    for (TimeNs i = 0; i < 600; ++i) {
      const TimeNs time_ns = begin_ns + i * 10 * ms - (i < 300 ? 0 : 100'000 * ms);
      imu.push_back(imu_at(time_ns));
      expect('I', time_ns);
      if (i % 10 != 5) continue;
      fixes.push_back(fix_at(time_ns + ms));
      headings.push_back(heading_at(time_ns + ms));
      expect('F', time_ns + ms);
      expect('H', time_ns + ms);
    }
    THEN("each fix and heading stays among the IMU samples of its time") {
      CHECK(order_of(merged(imu, fixes, headings)) == expected);
    }
    THEN("a late row of the IMU, and fixes that are a little out of order, cut nothing") {
      std::vector<ImuSample> steady;
      for (TimeNs i = 0; i < 600; ++i)
        steady.push_back(imu_at(begin_ns + i * 10 * ms - (i == 300 ? 120 * ms : 0)));
      std::vector<UltrasonicFix> nearly;
      for (TimeNs i = 0; i < 60; ++i) nearly.push_back(fix_at(begin_ns + i * 100 * ms));
      std::swap(nearly[37], nearly[38]);
      nearly[37].received_time_ns = nearly[38].received_time_ns + ms;
      TimeNs newest_imu_ns = 0;
      for (const Event& event : merged(steady, nearly, {})) {
        if (std::holds_alternative<ImuSample>(event)) {
          newest_imu_ns = std::max(newest_imu_ns, available_at_ns(event));
        } else {
          CHECK(available_at_ns(event) < newest_imu_ns + 200 * ms);
        }
      }
    }
    THEN("a step of the fixes alone cuts nothing: no sample is lost, and each file keeps its order") {
      std::vector<ImuSample> steady;
      for (TimeNs i = 0; i < 600; ++i) steady.push_back(imu_at(begin_ns + i * 10 * ms));
      const std::vector<Event> events = merged(steady, fixes, {});
      CHECK(events.size() == steady.size() + fixes.size());
      CHECK(available_at_ns(events.back()) == available_at_ns(steady.back()));
    }
  }
  GIVEN("the latest possible time") {
    constexpr TimeNs last = std::numeric_limits<TimeNs>::max();
    THEN("nothing is lost") {
      CHECK(merged({imu_at(last)}, {fix_at(last)}, {heading_at(last), heading_at(last)}).size() == 4);
    }
  }
}

SCENARIO("files written by other programs are accepted") {
  const TemporaryFolder log;
  write_text(log / "ultrasonic.csv", fix_header);
  GIVEN("Windows line ends, a byte-order mark, blank lines, and no newline at the end") {
    write_text(log / "imu.csv",
               "\xEF\xBB\xBF#timestamp,w_x,w_y,w_z,a_x,a_y,a_z\r\n1,0,0,0,0,0,9.8\r\n\r\n2,0,0,0,0,0,9.7");
    THEN("both rows are read") {
      const auto read = read_sensor_log(log.path());
      REQUIRE(read.events.size() == 2);
      CHECK(std::get<ImuSample>(read.events[1]).specific_force_body_mps2.z() == 9.7);
    }
  }
  GIVEN("tables with other names, and the files of a replay") {
    write_text(log / "imu.csv", imu_header + "1,0,0,0,0,0,9.8\n");
    for (const char* const name : {"Heading.CSV", "positions.csv", "pose.csv", "fixes.csv", "notes.txt"}) {
      write_text(log / name, "anything");
    }
    THEN("the tables that are not read are named once") {
      const auto warnings = read_sensor_log(log.path()).warnings;
      REQUIRE(warnings.size() == 1);
      CHECK(warnings[0] == log.path().string() + ": not read: Heading.CSV, positions.csv");
    }
  }
  GIVEN("no heading and no truth file, and a fix file without rows") {
    write_text(log / "imu.csv", imu_header + "1,0,0,0,0,0,9.8\n");
    THEN("that is a log of a single beacon that had no fix") {
      CHECK(order_of(read_sensor_log(log.path()).events) == "I1");
      CHECK(read_sensor_log(log.path()).truth.empty());
    }
  }
  GIVEN("values that are not finite") {
    write_text(log / "imu.csv", imu_header + "1,nan,-inf,0,0,0,1e308\n");
    THEN("they are passed on: the engine checks them") {
      const auto imu = std::get<ImuSample>(read_sensor_log(log.path()).events.at(0));
      CHECK(std::isnan(imu.angular_velocity_body_radps.x()));
      CHECK(imu.angular_velocity_body_radps.y() == -std::numeric_limits<double>::infinity());
    }
  }
}

}  // namespace log_folder_test
