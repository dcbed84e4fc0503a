#include "motion/imu_faults.hpp"

#include "motion/fix_faults.hpp"
#include <sonopose/statistics/quantile.hpp>
#include <sonopose/text/number_text.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace sonopose::motion {
namespace {

constexpr std::size_t min_readings = 100;
constexpr double varying_share = 0.2;  // noise alone changes nearly every reading

/// Readings in a row, from the first to before the end.
struct Row {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Rows in which each reading continues the one before, of at least a quarter of a second: no noise does.
template <class Continues>
std::vector<Row> long_rows(const std::vector<Reading>& imu, const Continues& continues) {
  constexpr double min_s = 0.25;
  constexpr std::size_t min_count = 10;
  std::vector<Row> rows;
  for (std::size_t begin = 0; begin < imu.size();) {
    std::size_t end = begin + 1;
    while (end < imu.size() && continues(imu[end - 1], imu[end])) ++end;
    const double length_s = seconds_between(imu[begin].time_ns, imu[end - 1].time_ns);
    if (end - begin >= min_count && length_s >= min_s) rows.push_back({begin, end});
    begin = end;
  }
  return rows;
}

std::string seconds_text(double duration_s) {
  return text::number_text(duration_s, 2) + " s";
}

/// "for 3.00 s", or with the sum of several rows.
std::string duration_text_of(const std::vector<Row>& rows, const std::vector<Reading>& imu) {
  double sum_s = 0;
  double longest_s = 0;
  for (const Row& row : rows) {
    const double length_s = seconds_between(imu[row.begin].time_ns, imu[row.end - 1].time_ns);
    sum_s += length_s;
    longest_s = std::max(longest_s, length_s);
  }
  if (rows.size() == 1) return "for " + seconds_text(sum_s);
  return "for up to " + seconds_text(longest_s) + ", " + seconds_text(sum_s) + " in total";
}

std::vector<Row> zero_rows(const std::vector<Reading>& imu) {
  return long_rows(imu, [](const Reading& before, const Reading& reading) {
    return before.force_body_mps2.isZero(0.0) && reading.force_body_mps2.isZero(0.0);
  });
}

bool is_repeated(const Reading& before, const Reading& reading) {
  return before.force_body_mps2 == reading.force_body_mps2 &&
         before.rate_body_radps == reading.rate_body_radps;
}

/// True if the fixes are away from their place at the begin of a row by more than their noise: at its end, or
/// most of the time, as on a way that returns.
bool moves_in(const Row& row, const Window& window) {
  constexpr double min_m = 0.3;
  const auto is_before = [](const Position& fix, TimeNs time_ns) { return fix.time_ns < time_ns; };
  const auto find = [&](std::size_t reading) {
    return std::lower_bound(window.fixes.begin(), window.fixes.end(), window.imu[reading].time_ns, is_before);
  };
  const auto from = find(row.begin);
  const auto to = find(row.end - 1);
  if (to <= from) return false;
  const auto is_away = [&](const Position& fix) {
    return (fix.position_world_m - from->position_world_m).norm() > min_m;
  };
  return is_away(to == window.fixes.end() ? window.fixes.back() : *to) ||
         2 * std::count_if(from, to, is_away) > to - from;
}

/// Rows of one sample while the body moves. A simulation without noise may have them in steady motion:
/// between them some axis, such as that of gravity, is constant too, or most samples are equal.
std::vector<Row> repeated_rows(const Window& window) {
  constexpr double constant_share = 0.9;
  const std::vector<Reading>& imu = window.imu;
  std::vector<Row> rows = long_rows(imu, is_repeated);
  if (std::none_of(rows.begin(), rows.end(), [&](const Row& row) { return moves_in(row, window); }))
    return {};
  double others = 0;
  double equal = 0;
  Vector3d equal_rates = Vector3d::Zero();
  Vector3d equal_forces = Vector3d::Zero();
  auto row = rows.begin();
  for (std::size_t i = 1; i < imu.size(); ++i) {
    if (row != rows.end() && i >= row->end) ++row;
    if (row != rows.end() && i > row->begin) continue;
    const Reading& before = imu[i - 1];
    ++others;
    equal += is_repeated(before, imu[i]) ? 1.0 : 0.0;
    equal_rates += (before.rate_body_radps.array() == imu[i].rate_body_radps.array()).cast<double>().matrix();
    equal_forces +=
        (before.force_body_mps2.array() == imu[i].force_body_mps2.array()).cast<double>().matrix();
  }
  const bool has_no_noise =
      std::max(equal_rates.maxCoeff(), equal_forces.maxCoeff()) > constant_share * others;
  if (has_no_noise || equal > varying_share * others) return {};
  return rows;
}

/// True if samples are less like those beside them than like the next but one, by a difference that keeps its
/// sign. Motion and noise do not alternate so, and a vibration near half of the rate beats.
bool alternates(const std::vector<Reading>& imu, Vector3d Reading::*reading) {
  constexpr double min_ratio = 4.0;
  constexpr double min_constant_share = 0.25;
  double to_last = 0;
  double to_last_but_one = 0;
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 2; i < imu.size(); ++i) {
    to_last += (imu[i].*reading - imu[i - 1].*reading).squaredNorm();
    to_last_but_one += (imu[i].*reading - imu[i - 2].*reading).squaredNorm();
    sum += (i % 2 == 0 ? 1.0 : -1.0) * (imu[i].*reading - imu[i - 1].*reading);
  }
  const auto count = static_cast<double>(imu.size());
  return to_last > min_ratio * to_last_but_one && sum.squaredNorm() > min_constant_share * count * to_last;
}

/// A sensor's axes: their medians, and the shares of the readings that are the median.
struct Sensor {
  const char* name;
  const char* unit;
  Vector3d Reading::*reading;
  Vector3d median = Vector3d::Zero();
  Vector3d share = Vector3d::Zero();
};

void add_stuck(const Sensor& sensor, const Sensor& other, bool is_moving, std::vector<std::string>& texts) {
  constexpr double stuck_share = 0.98;  // of the readings; some may be wrong
  if (sensor.share.minCoeff() > varying_share) {
    // At rest, a gyroscope may suppress its noise.
    const bool is_other_varying = other.share.minCoeff() <= varying_share;
    if (!is_moving || !is_other_varying || sensor.share.minCoeff() < stuck_share) return;
    texts.push_back(std::string("the ") + sensor.name + " is stuck at " +
                    text::number_text(sensor.median.x(), 2) + ' ' + text::number_text(sensor.median.y(), 2) +
                    ' ' + text::number_text(sensor.median.z(), 2) + ' ' + sensor.unit);
    return;
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (sensor.share(axis) < stuck_share) continue;
    std::string& finding = texts.emplace_back("axis ");
    finding.append(1, "xyz"[axis]).append(" of the ").append(sensor.name).append(" is stuck at ");
    finding.append(text::number_text(sensor.median(axis), 2)).append(1, ' ').append(sensor.unit);
  }
}

}  // namespace

void remove_held_readings(Window& window) {
  const auto remove = [&imu = window.imu](const std::vector<Row>& rows) {
    std::vector<Reading> others;
    std::size_t next = 0;
    const auto keep_until = [&](std::size_t end) {
      for (; next < end; ++next) others.push_back(imu[next]);
    };
    for (const Row& row : rows) {
      keep_until(row.begin);
      next = row.end;
    }
    keep_until(imu.size());
    imu = std::move(others);
  };
  remove(zero_rows(window.imu));
  remove(repeated_rows(window));
}

std::vector<std::string> imu_faults_of(const Window& window) {
  const std::vector<Reading>& imu = window.imu;
  if (imu.size() < min_readings) return {};
  if (const auto zeros = zero_rows(imu); !zeros.empty()) {
    return {"the accelerometer reads 0 0 0 " + duration_text_of(zeros, imu)};
  }
  if (const auto repeated = repeated_rows(window); !repeated.empty()) {
    return {"the IMU repeats one sample " + duration_text_of(repeated, imu)};
  }
  if (alternates(imu, &Reading::rate_body_radps) || alternates(imu, &Reading::force_body_mps2)) {
    return {
        "IMU samples alternate, as where two IMUs publish on one topic (keep one), or where one vibrates at "
        "half of its rate"};
  }
  std::array<Sensor, 2> sensors{{{"gyroscope", "rad/s", &Reading::rate_body_radps},
                                 {"accelerometer", "m/s^2", &Reading::force_body_mps2}}};
  for (Sensor& sensor : sensors) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const Reading& reading : imu) values.push_back((reading.*sensor.reading)(axis));
      sensor.median(axis) = statistics::quantile(values, 0.5);
      sensor.share(axis) =
          static_cast<double>(std::count(values.begin(), values.end(), sensor.median(axis))) /
          static_cast<double>(values.size());
    }
  }
  std::vector<std::string> texts;
  const bool is_moving = are_moving(window.fixes);
  add_stuck(sensors[0], sensors[1], is_moving, texts);
  add_stuck(sensors[1], sensors[0], is_moving, texts);
  return texts;
}

}  // namespace sonopose::motion
