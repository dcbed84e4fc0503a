#pragma once
/// \file
/// Reads tables of IMU samples and positions with any column names, which are not a log folder.

#include "csv/column_names.hpp"
#include "recording/log_folder.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recording {

/// The tables; two may be the same file.
struct TableFiles {
  std::filesystem::path imu;
  std::filesystem::path positions;             ///< fixes
  std::optional<std::filesystem::path> truth;  ///< positions, or poses
  TimeNs position_shift_ns = 0;                ///< added to the times of the positions
  /// Device whose rows are read, where a table has several; empty: the one of the address.
  std::string tag{};
};

struct Tables {
  SensorLog log;
  std::size_t rows_without_imu = 0;              ///< rows that lack an IMU value; of a common table, some
  std::size_t rows_without_position = 0;         ///< rows of the positions' table that lack time, x, y or z
  std::size_t rows_of_other_tags = 0;            ///< rows that name another device
  bool has_height = true;                        ///< false if the positions have no z, which is then 0
  std::size_t repeated_positions = 0;            ///< rows that repeat the position of the row before
  TimeNs times_moved_ns = 0;                     ///< added to all times, because they began at zero
  TimeNs position_shift_ns = 0;                  ///< added to those of the positions before, as requested
  std::vector<std::string> unused_columns = {};  ///< `FILE: NAME`
};

/// Reads the tables; `names` gives the columns of all files. A position is taken for measured at its time,
/// and for received then unless the table has a column `received`. If the positions' table is the IMU's too,
/// rows that repeat a position are left out. Of several devices in a table, that of `TableFiles::tag` counts.
/// Throws files::IoError, also for a given name that no file has.
Tables read_tables(const TableFiles& files, csv::ColumnNames& names, BeaconAddress address);

}  // namespace sonopose::recording
