#pragma once
/// \file
/// Checks of recorded input, before anything is made of it: stamps, units and what is missing.

#include "motion/window.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::recording {

/// Collects what is wrong with the samples of one beacon. Add each stream in its own order.
class InputCheck {
public:
  void add(const ImuSample& imu);
  void add(const UltrasonicFix& fix);
  void add(const PairHeading& heading);
  void add(const Event& event);

  /// One sentence for each finding, the gravest first.
  [[nodiscard]] std::vector<std::string> findings() const;

private:
  using Stamps = std::vector<TimeNs>;  ///< stamps of one stream, in its order

  static std::optional<std::string> unit_of_time(const char* what, const Stamps& stamps, double min_rate_hz,
                                                 double max_rate_hz);
  static std::optional<std::string> order(const char* what, const Stamps& stamps);
  [[nodiscard]] std::optional<std::string> overlap(const char* what, const Stamps& stamps) const;
  static std::optional<std::string> age(const char* what, const std::vector<TimeNs>& ages_ns);
  [[nodiscard]] std::vector<std::string> units_of_readings() const;

  Stamps imu_;
  Stamps fixes_;
  Stamps headings_;
  std::vector<TimeNs> fix_ages_ns_;  ///< durations from emission to reception
  std::vector<TimeNs> heading_ages_ns_;
  std::vector<motion::Reading> readings_;
};

/// Findings about a recording, each after its name.
std::vector<std::string> input_findings(const std::string& name, const std::vector<Event>& events);
std::vector<std::string> input_findings(const std::string& name, const std::vector<ImuSample>& imu);

}  // namespace sonopose::recording
