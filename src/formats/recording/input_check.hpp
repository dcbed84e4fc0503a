#pragma once
/// \file
/// Checks of recorded input, before anything is made of it: stamps, units and what is missing.

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
  void add(const Event& event);

  /// One sentence for each finding, the gravest first.
  [[nodiscard]] std::vector<std::string> findings() const;

private:
  /// The stamps of a stream.
  struct Stamps {
    void add(TimeNs time_ns);

    std::size_t count = 0;
    std::size_t earlier = 0;  ///< number of stamps that are earlier than the one before
    std::size_t equal = 0;    ///< number of stamps that equal the one before
    TimeNs min_ns = 0;
    TimeNs max_ns = 0;
    TimeNs last_ns = 0;
    TimeNs first_earlier_ns = 0;  ///< the first of them
    TimeNs before_it_ns = 0;
    std::vector<TimeNs> steps_ns;  ///< positive differences
  };

  [[nodiscard]] std::optional<std::string> unit_of_time(const char* what, const Stamps& stamps,
                                                        double min_rate_hz, double max_rate_hz) const;
  [[nodiscard]] std::optional<std::string> order(const char* what, const Stamps& stamps) const;
  [[nodiscard]] std::optional<std::string> overlap() const;
  [[nodiscard]] std::optional<std::string> unit_of_force() const;
  [[nodiscard]] std::optional<std::string> unit_of_rate() const;

  Stamps imu_;
  Stamps fixes_;
  std::vector<double> forces_mps2_;
  std::vector<double> rates_radps_;
};

/// Findings about a recording, each after its name.
std::vector<std::string> input_findings(const std::string& name, const std::vector<Event>& events);
std::vector<std::string> input_findings(const std::string& name, const std::vector<ImuSample>& imu);

}  // namespace sonopose::recording
