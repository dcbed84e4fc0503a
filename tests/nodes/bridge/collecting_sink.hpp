#pragma once
/// \file
/// A sink that stores the output of a source.

#include "publication/source.hpp"
#include "support/events.hpp"

#include <vector>

namespace sonopose::test {

class CollectingSink : public publication::SampleSink {
public:
  void on(const Event& event) override {
    events.push_back(event);
    if (stop != nullptr && events.size() == stop_after) stop->request();
  }
  void on(const TruthSample& sample) override { truth.push_back(sample); }
  void on(const BeaconStatus& status) override { statuses.push_back(status); }
  void on_stationary(const StationaryBeacon& beacon) override { stationary.push_back(beacon); }
  void on(const LineStatus& status) override { lines.push_back(status); }
  void tick() override { ++ticks; }

  /// Events of one kind, in order.
  template <class Sample>
  [[nodiscard]] std::vector<Sample> of_kind() const {
    return test::samples_of<Sample>(events);
  }

  std::vector<Event> events;
  std::vector<TruthSample> truth;
  std::vector<BeaconStatus> statuses;
  std::vector<LineStatus> lines;
  std::vector<StationaryBeacon> stationary;
  int ticks = 0;
  process::StopSignal* stop = nullptr;  ///< stopped at event number `stop_after`
  std::size_t stop_after = 0;
};

}  // namespace sonopose::test
