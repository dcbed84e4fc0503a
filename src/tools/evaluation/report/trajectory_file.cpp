#include "evaluation/report/trajectory_file.hpp"

#include "files/error.hpp"

#include <array>
#include <string_view>
#include <system_error>

namespace sonopose::evaluation {
namespace {

constexpr std::array<std::string_view, 8> columns{"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};

}  // namespace

TrajectoryFile::TrajectoryFile(const std::filesystem::path& file)
    : place_(file), rows_(place_.part(), csv::Writer::Existing::replace, ' ') {
  rows_.header(columns);
}

void TrajectoryFile::write(TimeNs time_ns, const Vector3d& position_world_m,
                           const Quaterniond& q_body_to_world) {
  const Quaterniond& q = q_body_to_world;
  rows_.seconds(time_ns).vector(position_world_m);
  rows_.number(q.x()).number(q.y()).number(q.z()).number(q.w()).end_row();
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  create_directories(folder, error);
  if (error) throw files::IoError(folder.string() + ": cannot be created: " + error.message());
}

}  // namespace sonopose::evaluation
