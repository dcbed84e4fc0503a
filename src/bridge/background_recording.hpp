#pragma once
/// \file
/// Records what a bridge publishes without delaying it.

#include "bridge/background_writer.hpp"
#include "bridge/beacon_recorder.hpp"
#include "process/stop_signal.hpp"
#include "recording/log_meta.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <variant>

namespace sonopose::bridge {

/// A recording that is written on a thread of its own. An error ends it, and nothing else.
class BackgroundRecording {
public:
  using Sample = std::variant<Event, TruthSample>;

  /// `settings` are those of the source. Throws files::IoError as `BeaconRecorder` does.
  BackgroundRecording(const std::filesystem::path& folder, recording::LogSettings settings,
                      WhenFull when_full);

  /// From soon after the stop on, the source no longer waits for the disk. `stop` must outlive this.
  void obey(const process::StopSignal& stop) { writer_.obey(stop); }

  /// Does not allocate. One thread only.
  void push(const Sample& sample) { writer_.push({&sample, 1}); }

  /// Samples that were not recorded. From any thread.
  [[nodiscard]] std::uint64_t lost() const { return writer_.lost(); }

  /// Waits until everything is recorded. Throws files::IoError if samples were not.
  void finish();

private:
  std::shared_ptr<BeaconRecorder> recorder_;
  BackgroundWriter<Sample> writer_;
};

}  // namespace sonopose::bridge
