#include "publication/background_recording.hpp"

#include "files/error.hpp"
#include "logging/log.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <span>
#include <utility>

namespace sonopose::publication {
namespace {

/// Seconds of a thousand beacons, or minutes of one.
constexpr std::size_t capacity = 1U << 15U;

}  // namespace

BackgroundRecording::BackgroundRecording(const std::filesystem::path& folder, recording::LogSettings settings,
                                         FullQueuePolicy when_full)
    : recorder_(std::make_shared<BeaconRecorder>(folder, std::move(settings))),
      writer_({"the recording", "sample"}, capacity, when_full,
              [recorder = recorder_](std::span<const Sample> samples) {
                for (const Sample& sample : samples) {
                  std::visit([&recorder](const auto& each) { recorder->write(each); }, sample);
                }
                recorder->flush();
              }) {}

void BackgroundRecording::finish() {
  try {
    writer_.finish();
  } catch (const files::IoError& error) {
    throw files::IoError(fmt::format("{}; it is in {}", error.what(), recorder_->part().string()));
  }
  if (recorder_->is_empty()) logging::warning("no beacon was heard, so there is no recording");
  recorder_->finish();
}

}  // namespace sonopose::publication
