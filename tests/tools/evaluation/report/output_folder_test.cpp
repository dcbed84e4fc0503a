#include "evaluation/report/output_folder.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace output_folder_test {

using namespace sonopose;
using namespace sonopose::test;
using evaluation::OutputFolder;

FusedPose sample_pose() {
  FusedPose pose;
  pose.time_ns = 1'700'000'000'005'000'001;
  pose.position_world_m = {1.5, -0.1, 1.0 / 3.0};
  pose.q_body_to_world = {0.5, 0.5, -0.5, 0.5};
  pose.velocity_world_mps = {0, 1e-9, -2};
  pose.status = status_stale | status_heading_unknown;
  return pose;
}

FixReport sample_report() {
  FixReport report;
  report.address = 7;
  report.sequence = 12;
  report.emission_time_ns = 100;
  report.applied_time_ns = 168;
  report.position_world_m = {1, 2, 3};
  report.shifted_position_world_m = {1.25, 2, 3};
  report.innovation_world_m = {0.5, 0, 0};
  report.weight = 0.25;
  report.trust = 0.75;
  report.jump_world_m = {0.1, 0.2, 0.3};
  report.velocity_change_world_mps = {-0.1, -0.2, -0.3};
  report.yaw_change_rad = 0.01;
  report.flags = fix_used | fix_outlier;
  return report;
}

TEST_CASE("both files contain a pose without loss of precision, the trajectory only with a position") {
  const TemporaryFolder folder;
  {
    OutputFolder out(folder / "a");
    FusedPose without_position = sample_pose();
    without_position.time_ns -= 1;
    without_position.status = status_initialising;
    out.write(without_position);
    out.write(sample_pose());
    out.finish();
  }
  CHECK(read_text(folder / "a/trajectory.tum") ==
        "#timestamp tx ty tz qx qy qz qw\n"
        "1700000000.005000001 1.5 -0.1 0.3333333333333333 0.5 -0.5 0.5 0.5\n");
  CHECK(read_text(folder / "a/pose.csv") ==
        "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w [],q_x [],q_y [],q_z [],v_x [m s^-1],v_y [m s^-1],v_z "
        "[m s^-1],"
        "status []\n"
        "1700000000005000000,1.5,-0.1,0.3333333333333333,0.5,0.5,-0.5,0.5,0,1e-09,-2,1\n"
        "1700000000005000001,1.5,-0.1,0.3333333333333333,0.5,0.5,-0.5,0.5,0,1e-09,-2,20\n");
}

TEST_CASE("covariances are written on request, and those of an earlier run are removed") {
  const TemporaryFolder folder;
  FusedPose pose = sample_pose();
  pose.pose_covariance = Covariance<6>::from_diagonal({1, 2, 3, 4, 5, 6});
  pose.pose_covariance.set(0, 2, 0.5);
  pose.pose_covariance.set(3, 4, -0.25);
  pose.velocity_covariance = Covariance<3>::from_diagonal({7, 8, 9});
  {
    OutputFolder out(folder / "a", OutputFolder::Covariances::yes);
    out.write(pose);
    out.finish();
  }
  const std::string text = read_text(folder / "a/covariance.csv");
  CHECK(text.substr(text.find('\n') + 1) ==
        "1700000000005000001,1,0,0.5,2,0,3,4,-0.25,0,5,0,6,7,0,0,8,0,9\n");
  OutputFolder(folder / "a").finish();
  CHECK_FALSE(exists(folder / "a/covariance.csv"));
}

TEST_CASE("fixes.csv contains every field of a report, and the flags by name") {
  const TemporaryFolder folder;
  {
    OutputFolder out(folder.path());
    out.write(sample_report());
    out.finish();
  }
  const std::string text = read_text(folder / "fixes.csv");
  const std::string row = text.substr(text.find('\n') + 1);
  CHECK(row == "100,168,7,12,1,2,3,1.25,2,3,0.5,0.25,0.75,0.1,0.2,0.3,-0.1,-0.2,-0.3,0.01,used|outlier,3\n");
  const std::string header = text.substr(0, text.find('\n'));
  CHECK(std::count(header.begin(), header.end(), ',') == std::count(row.begin(), row.end(), ','));
}

TEST_CASE("the files of an earlier run are replaced, other files remain") {
  const TemporaryFolder folder;
  write_text(folder / "notes.txt", "mine");
  for (int run = 0; run < 2; ++run) {
    OutputFolder out(folder.path());
    out.write(sample_pose());
    out.finish();
  }
  const std::string text = read_text(folder / "pose.csv");
  CHECK(std::count(text.begin(), text.end(), '\n') == 2);
  CHECK(read_text(folder / "notes.txt") == "mine");
}

TEST_CASE("an incomplete run keeps the files of the previous run") {
  const TemporaryFolder folder;
  for (const char* name : {"trajectory.tum", "pose.csv", "fixes.csv"}) write_text(folder / name, "before");
  OutputFolder(folder.path()).write(sample_pose());
  for (const char* name : {"trajectory.tum", "pose.csv", "fixes.csv"}) {
    CHECK(read_text(folder / name) == "before");
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 3);
}

TEST_CASE("a full disk and a folder that cannot be created are named") {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder / "pose.csv");
  OutputFolder out(folder.path());
  out.write(sample_pose());
  CHECK_THROWS_WITH(out.finish(), Catch::Contains("pose.csv") && Catch::Contains("No space left"));
  write_text(folder / "file", "");
  CHECK_THROWS_WITH(OutputFolder(folder / "file/out"), Catch::Contains("file/out: cannot be created"));
}

}  // namespace output_folder_test
