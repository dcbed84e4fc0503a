#pragma once
/// \file
/// Records the published samples of a bridge without delaying it.

#include "process/stop_signal.hpp"
#include "publication/background_writer.hpp"
#include "publication/beacon_recorder.hpp"
#include "recording/log_meta.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <variant>

namespace sonopose::publication {

/// A recording that is written on its own thread. An error ends only the recording.
class BackgroundRecording {
public:
  using Sample = std::variant<Event, TruthSample>;

  /// `settings`: settings of the source. Throws files::IoError like `BeaconRecorder`.
  BackgroundRecording(const std::filesystem::path& folder, recording::LogSettings settings,
                      FullQueuePolicy when_full);

  /// Ends the waits of the source for the disk soon after the stop. `stop` must outlive this object.
  void obey(const process::StopSignal& stop) { writer_.obey(stop); }

  /// Records a sample. Does not allocate. One thread only.
  void push(const Sample& sample) { writer_.push({&sample, 1}); }

  /// Number of samples that were not recorded. From any thread.
  [[nodiscard]] std::uint64_t lost() const { return writer_.lost(); }

  /// Waits until everything is recorded. Throws files::IoError if samples were lost.
  void finish();

private:
  std::shared_ptr<BeaconRecorder> recorder_;
  BackgroundWriter<Sample> writer_;
};

}  // namespace sonopose::publication
