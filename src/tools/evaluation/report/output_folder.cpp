#include "evaluation/report/output_folder.hpp"

#include "evaluation/score/fix_flag_counts.hpp"
#include "recording/log_columns.hpp"

#include <array>
#include <string_view>
#include <system_error>
#include <vector>

namespace sonopose::evaluation {
namespace {

constexpr std::array<std::string_view, 12> pose_columns{
    "timestamp [ns]", "p_x [m]", "p_y [m]",      "p_z [m]",      "q_w []",       "q_x []",
    "q_y []",         "q_z []",  "v_x [m s^-1]", "v_y [m s^-1]", "v_z [m s^-1]", "status []"};
constexpr std::array<std::string_view, 19> covariance_columns{
    "timestamp [ns]",  "p_xx [m^2]",      "p_xy [m^2]",      "p_xz [m^2]",      "p_yy [m^2]",
    "p_yz [m^2]",      "p_zz [m^2]",      "r_xx [rad^2]",    "r_xy [rad^2]",    "r_xz [rad^2]",
    "r_yy [rad^2]",    "r_yz [rad^2]",    "r_zz [rad^2]",    "v_xx [m^2 s^-2]", "v_xy [m^2 s^-2]",
    "v_xz [m^2 s^-2]", "v_yy [m^2 s^-2]", "v_yz [m^2 s^-2]", "v_zz [m^2 s^-2]"};
constexpr std::array<std::string_view, 22> fix_columns{
    "timestamp [ns]", "applied [ns]",    "beacon []",     "sequence []",   "x [m]",
    "y [m]",          "z [m]",           "shifted_x [m]", "shifted_y [m]", "shifted_z [m]",
    "innovation [m]", "weight []",       "trust []",      "jump_x [m]",    "jump_y [m]",
    "jump_z [m]",     "dv_x [m s^-1]",   "dv_y [m s^-1]", "dv_z [m s^-1]", "yaw_change [rad]",
    "fix_flags []",   "fix_flag_bits []"};

const std::filesystem::path& created(const std::filesystem::path& folder) {
  make_folder(folder);
  return folder;
}

}  // namespace

OutputFolder::OutputFolder(const std::filesystem::path& folder, Covariances covariances)
    : covariance_file_(folder / recording::covariance_file),
      trajectory_(created(folder) / "trajectory.tum"),
      poses_{folder / recording::pose_file},
      fixes_{folder / recording::fixes_file} {
  poses_.rows.header(pose_columns);
  fixes_.rows.header(fix_columns);
  if (covariances == Covariances::no) return;
  covariances_.emplace(covariance_file_);
  covariances_->rows.header(covariance_columns);
}

void OutputFolder::write(const FusedPose& pose) {
  const Quaterniond& q = pose.q_body_to_world;
  // Tools that align a trajectory take every row for a position.
  const bool has_position = (pose.status & status_initialising) == 0U;
  if (has_position) trajectory_.write(pose.time_ns, pose.position_world_m, q);
  poses_.rows.integer(pose.time_ns).vector(pose.position_world_m);
  poses_.rows.number(q.w()).number(q.x()).number(q.y()).number(q.z());
  poses_.rows.vector(pose.velocity_world_mps).integer(pose.status).end_row();
  if (covariances_) write_covariances(pose);
}

void OutputFolder::write_covariances(const FusedPose& pose) {
  csv::Writer& rows = covariances_->rows;
  const auto write_triangle = [&rows](const auto& covariance, int first) {
    for (int row = first; row < first + 3; ++row) {
      for (int column = row; column < first + 3; ++column) rows.number(covariance.at(row, column));
    }
  };
  rows.integer(pose.time_ns);
  write_triangle(pose.pose_covariance, 0);
  write_triangle(pose.pose_covariance, 3);
  write_triangle(pose.velocity_covariance, 0);
  rows.end_row();
}

void OutputFolder::write(const FixReport& report) {
  fixes_.rows.integer(report.emission_time_ns).integer(report.applied_time_ns);
  fixes_.rows.integer(report.address).integer(static_cast<std::int64_t>(report.sequence));
  fixes_.rows.vector(report.position_world_m).vector(report.shifted_position_world_m);
  fixes_.rows.number(report.innovation_world_m.norm()).number(report.weight).number(report.trust);
  fixes_.rows.vector(report.jump_world_m).vector(report.velocity_change_world_mps);
  fixes_.rows.number(report.yaw_change_rad).text(fix_flag_text(report.flags)).integer(report.flags).end_row();
}

void OutputFolder::finish() {
  std::vector<Table*> tables{&poses_, &fixes_};
  if (covariances_) tables.push_back(&*covariances_);
  trajectory_.flush();
  for (Table* table : tables) table->rows.flush();
  trajectory_.commit();
  for (Table* table : tables) table->place.commit();
  // The file of an earlier run does not belong to these poses.
  std::error_code ignored;
  if (!covariances_) std::filesystem::remove(covariance_file_, ignored);
}

}  // namespace sonopose::evaluation
