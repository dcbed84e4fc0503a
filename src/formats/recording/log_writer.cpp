#include "recording/log_writer.hpp"

#include "clocks/clocks.hpp"
#include "csv/units.hpp"
#include "csv/writer.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "recording/log_columns.hpp"
#include "recording/part_folder.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <limits>
#include <span>
#include <string>
#include <utility>

namespace sonopose::recording {

namespace {

constexpr TimeNs flush_period_ns = 200'000'000;

std::unique_ptr<csv::Writer> new_file(const std::filesystem::path& file) {
  return std::make_unique<csv::Writer>(file, csv::Writer::Existing::refuse);
}

}  // namespace

SensorLogWriter::SensorLogWriter(std::filesystem::path folder, LogSettings settings)
    : folder_{std::move(folder)}, last_flush_{clocks::steady_now()} {
  refuse_recording_in(folder_);
  std::error_code error;
  create_directories(folder_, error);
  if (error) throw files::IoError(folder_.string() + ": cannot be created: " + error.message());
  imu_ = new_file(folder_ / imu_file);
  ultrasonic_ = new_file(folder_ / ultrasonic_file);
  heading_ = new_file(folder_ / heading_file);
  ultrasonic_->header(ultrasonic_columns);
  heading_->header(heading_columns);
  meta_.program_version = program_version();
  meta_.settings = std::move(settings);
  write_log_meta(folder_, meta_);
}

SensorLogWriter::~SensorLogWriter() {
  try {
    if (!with_magnetometer_) write_imu_header(false);
    flush();
    if (magnetic_fields_dropped_ > 0) {
      logging::warning(fmt::format("{}: {} not written, because the first sample had none",
                                   (folder_ / imu_file).string(),
                                   text::count_text(magnetic_fields_dropped_, "magnetic field")));
    }
    if (misread_ > 0) {
      logging::warning(fmt::format(
          "{}: a replay takes {} for those of the beacon and its pair: a log folder has no columns for the "
          "place of a tag, a heading of the body or a set pose",
          folder_.string(), text::count_text(misread_, "sample")));
    }
  } catch (const std::exception&) {  // a destructor cannot report errors
  }
}

void SensorLogWriter::write(const ImuSample& sample) {
  admit(sample.address);
  admit(sample.meaning);
  if (!with_magnetometer_) write_imu_header(sample.magnetic_field_body_t.has_value());
  imu_->integer(sample.sensor_time_ns);
  imu_->vector(sample.angular_velocity_body_radps).vector(sample.specific_force_body_mps2);
  if (*with_magnetometer_) {
    for (int axis = 0; axis < 3; ++axis) {
      if (sample.magnetic_field_body_t) {
        imu_->number_in(csv::microtesla, (*sample.magnetic_field_body_t)[axis]);
      } else {
        imu_->empty();
      }
    }
  } else if (sample.magnetic_field_body_t) {
    ++magnetic_fields_dropped_;
  }
  imu_->end_row();
  flush_when_due();
}

void SensorLogWriter::write(const UltrasonicFix& fix) {
  admit(fix.address);
  if (fix.point_body_m != Vector3d::Zero() || (fix.flags & ultrasonic_flag_set_pose) != 0) ++misread_;
  ultrasonic_->integer(fix.emission_time_ns).integer(fix.received_time_ns).vector(fix.position_world_m);
  if (fix.quality_percent) {
    ultrasonic_->number(*fix.quality_percent);
  } else {
    ultrasonic_->empty();
  }
  ultrasonic_->end_row();
  flush_when_due();
}

void SensorLogWriter::write(const PairHeading& heading) {
  admit(heading.address);
  if ((heading.flags & (heading_flag_of_body | heading_flag_set_pose)) != 0) ++misread_;
  heading_->integer(heading.emission_time_ns).integer(heading.received_time_ns);
  if (heading.valid) {
    heading_->number_in(csv::degree, heading.heading_world_rad);
  } else {
    heading_->empty();
  }
  heading_->end_row();
  flush_when_due();
}

void SensorLogWriter::write(const TwistSample& twist) {
  admit(twist.address);
  if (!twist_) {
    twist_ = new_file(folder_ / twist_file);
    twist_->header(twist_columns);
  }
  twist_->integer(twist.emission_time_ns).integer(twist.received_time_ns);
  const auto write_axes = [&](const Vector3d& value, std::uint32_t first_axis, double least) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((twist.axes & (first_axis << axis)) != 0 && value[axis] >= least) {
        twist_->number(value[axis]);
      } else {
        twist_->empty();
      }
    }
  };
  constexpr double any = -std::numeric_limits<double>::infinity();
  write_axes(twist.velocity_body_mps, twist_velocity_x, any);
  write_axes(twist.velocity_std_mps, twist_velocity_x, 0.0);
  write_axes(twist.angular_velocity_body_radps, twist_angular_velocity_x, any);
  twist_->end_row();
  flush_when_due();
}

void SensorLogWriter::write(const TruthSample& sample) {
  admit(sample.address);
  if (!truth_) {
    truth_ = new_file(folder_ / truth_file);
    truth_->header(std::span(truth_columns).first(truth_columns_written));
  }
  const Quaterniond& q = sample.q_body_to_world;
  truth_->integer(sample.time_ns);
  for (const double x : sample.position_world_m) truth_->known_number(x);
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) truth_->known_number(x);
  for (const double v : sample.velocity_world_mps) truth_->known_number(v);
  truth_->end_row();
  flush_when_due();
}

void SensorLogWriter::write(const Event& event) {
  std::visit([this](const auto& sample) { write(sample); }, event);
}

void SensorLogWriter::flush() {
  last_flush_ = clocks::steady_now();
  for (csv::Writer* file : {imu_.get(), ultrasonic_.get(), heading_.get(), twist_.get(), truth_.get()}) {
    if (file != nullptr) file->flush();
  }
}

void SensorLogWriter::admit(BeaconAddress address) {
  if (meta_.beacon_address == address) return;
  if (meta_.beacon_address) {
    throw files::IoError(folder_.string() + ": is the recording of beacon " +
                         std::to_string(*meta_.beacon_address) + ", beacon " + std::to_string(address) +
                         " needs another folder");
  }
  meta_.beacon_address = address;
  write_log_meta(folder_, meta_);
}

void SensorLogWriter::admit(ImuMeaning meaning) {
  if (meta_.imu_meaning == meaning) return;
  const bool is_first = !with_magnetometer_;
  if (!is_first && meta_.imu_meaning == ImuMeaning::unknown) return;
  meta_.imu_meaning = is_first ? meaning : ImuMeaning::unknown;
  write_log_meta(folder_, meta_);
}

void SensorLogWriter::write_imu_header(bool with_magnetometer) {
  with_magnetometer_ = with_magnetometer;
  const std::span<const std::string_view> columns{imu_columns};
  imu_->header(with_magnetometer ? columns : columns.first(imu_columns_without_magnetometer));
}

void SensorLogWriter::flush_when_due() {
  if (clocks::steady_now() - last_flush_ > flush_period_ns) flush();
}

}  // namespace sonopose::recording
