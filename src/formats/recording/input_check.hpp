#pragma once
/// \file
/// Checks of recorded input, before anything is made of it: stamps, units and what is missing.

#include "csv/column_names.hpp"
#include "motion/fix_faults.hpp"
#include "motion/turn_gain.hpp"
#include "motion/window.hpp"
#include "recording/velocity_check.hpp"
#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::recording {

/// Collects what is wrong with the samples of one beacon. Add each stream in its own order.
class InputCheck {
public:
  /// `names`: those of imported tables, of which the IMU's is read first and then that of the positions.
  /// Findings then propose options of the import.
  explicit InputCheck(const csv::ColumnNames* names = nullptr) : names_(names) {}

  void add(const ImuSample& imu);
  void add(const UltrasonicFix& fix);
  void add(const PairHeading& heading);
  void add(const TwistSample& twist);
  void add(const TruthSample& truth);
  void add(const Event& event);

  /// One sentence for each finding, the gravest first.
  [[nodiscard]] std::vector<std::string> findings() const;

private:
  using Stamps = std::vector<TimeNs>;  ///< stamps of one stream, in its order

  /// Reader of a table in csv::ColumnNames.
  enum class Table : std::size_t { imu, positions };

  [[nodiscard]] std::string how_to_name(std::string_view unit, Table table,
                                        std::initializer_list<std::string_view> columns) const;
  [[nodiscard]] std::optional<std::string> unit_of_time(const char* what, const Stamps& stamps, Table table,
                                                        double min_rate_hz, double max_rate_hz) const;
  [[nodiscard]] std::optional<std::string> overlap(const char* what, const Stamps& stamps) const;
  /// The stream with which begin and end are compared.
  struct Reference {
    const char* what;
    const Stamps& stamps;
    double min_s;             ///< smallest shift
    double max_difference_s;  ///< difference of the shifts at begin and end
  };
  [[nodiscard]] static std::optional<std::string> shift(const char* what, const Stamps& stamps,
                                                        const Reference& other);
  static std::optional<std::string> age(const char* what, const std::vector<TimeNs>& ages_ns);
  [[nodiscard]] std::vector<std::string> units_of_readings(const motion::TurnGain& turn) const;
  [[nodiscard]] std::string question_about(const motion::FixFault& fault) const;
  [[nodiscard]] std::optional<std::string> unit_of_quality() const;

  const csv::ColumnNames* names_;
  Stamps imu_;
  Stamps fixes_;
  Stamps headings_;
  Stamps twists_;
  std::vector<TruthSample> truths_;
  std::optional<Vector3d> point_body_m_;  ///< place of the first tag, whose fixes are compared
  std::vector<double> qualities_percent_;
  std::vector<TimeNs> fix_ages_ns_;  ///< durations from emission to reception
  std::vector<TimeNs> heading_ages_ns_;
  std::vector<TimeNs> twist_ages_ns_;
  VelocityCheck velocities_;
  motion::Window window_;
};

/// Sentence about samples that are stamped earlier than one before them; empty if there are none.
std::optional<std::string> order_finding(const char* what, const std::vector<TimeNs>& stamps);

/// Sorts samples by time. Adds a sentence about those that were out of order, after the name, if there are
/// any.
template <class Sample>
void sort_by_time(const std::string& name, const char* what, std::vector<Sample>& samples,
                  std::vector<std::string>& warnings) {
  std::vector<TimeNs> stamps;
  for (const Sample& sample : samples) stamps.push_back(sample.time_ns);
  const auto finding = order_finding(what, stamps);
  if (!finding) return;
  warnings.push_back(name + ": " + *finding + "; they are sorted by time");
  std::ranges::stable_sort(samples, {}, &Sample::time_ns);
}

/// Findings about a recording, each after its name.
std::vector<std::string> input_findings(const std::string& name, const std::vector<Event>& events,
                                        const csv::ColumnNames* names = nullptr,
                                        const std::vector<TruthSample>& truths = {});
std::vector<std::string> input_findings(const std::string& name, const std::vector<ImuSample>& imu);

}  // namespace sonopose::recording
