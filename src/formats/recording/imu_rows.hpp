#pragma once
/// \file
/// Reads the rows of imu.csv one at a time. Private to this folder.

#include "csv/reader.hpp"
#include "csv/units.hpp"
#include "recording/log_columns.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <filesystem>

namespace sonopose::recording {

/// IMU samples of a file. A table with given names may lack values, and rows without them are left out.
class ImuRows {
public:
  ImuRows(const std::filesystem::path& file, BeaconAddress address, ImuMeaning meaning,
          const csv::Layout& layout = imu_layout())
      : rows_{file, layout}, is_table_(layout.given_names != nullptr) {
    sample_.address = address;
    sample_.meaning = meaning;
    step();
  }

  /// The current sample; null after the last.
  [[nodiscard]] const ImuSample* current() const { return at_end_ ? nullptr : &sample_; }

  void step() {
    for (;;) {
      at_end_ = !rows_.next_row();
      if (at_end_ || !is_table_ || rows_.filled(0, 7) == 7) break;
      ++left_out_;
      if (rows_.filled(1, 6) > 0) ++incomplete_;
    }
    if (at_end_) return;
    sample_.sensor_time_ns = rows_.time_ns(0);
    sample_.angular_velocity_body_radps = rows_.vector(1);
    sample_.specific_force_body_mps2 = rows_.vector(4);
    sample_.magnetic_field_body_t.reset();
    if (!rows_.all_filled(7, 3)) return;
    sample_.magnetic_field_body_t.emplace(rows_.number_in(csv::microtesla, 7),
                                          rows_.number_in(csv::microtesla, 8),
                                          rows_.number_in(csv::microtesla, 9));
  }

  [[nodiscard]] std::size_t expected_count() const { return at_end_ ? 0 : rows_.rows_like_this(); }
  /// Number of rows without all IMU values so far, and of those that have some.
  [[nodiscard]] std::size_t left_out() const { return left_out_; }
  [[nodiscard]] std::size_t incomplete() const { return incomplete_; }

private:
  csv::Reader rows_;
  bool is_table_;  ///< has rows of other measurements
  std::size_t left_out_ = 0;
  std::size_t incomplete_ = 0;
  ImuSample sample_;
  bool at_end_ = false;
};

}  // namespace sonopose::recording
