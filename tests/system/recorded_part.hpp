#pragma once
/// \file
/// A running recorder and the data that it has written so far.

#include "files/error.hpp"
#include "recorder/messages.hpp"
#include "support/bus.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::test {

/// Starts a recorder and returns once it is recording.
inline std::unique_ptr<Process> start_recording(const Bus& bus, const std::filesystem::path& file,
                                                const Arguments& options = {}) {
  Arguments arguments{file.string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  auto process = bus.record(arguments);
  REQUIRE(process->wait_for_line(Stream::error, "recording "));
  return process;
}

/// Waits until `done(messages)` for the messages in the file's part. A recorder that is told to end does not
/// wait for messages in transit.
template <class Done>
bool wait_for_part(std::filesystem::path file, const Done& done) {
  file += ".part";
  const auto give_up = std::chrono::steady_clock::now() + timeout;
  while (std::chrono::steady_clock::now() < give_up) {
    try {
      if (done(recorder::test::messages_of(file))) return true;
    } catch (const files::IoError&) {  // NOLINT(bugprone-empty-catch): the file has only begun
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

/// Waits until the part has this many messages of these topics.
inline bool wait_for_part(const std::filesystem::path& file, const std::vector<std::string>& names,
                          std::size_t count) {
  return wait_for_part(file, [&](const std::vector<recorder::test::OwnedMessage>& messages) {
    return std::count_if(messages.begin(), messages.end(), [&](const auto& message) {
             return std::find(names.begin(), names.end(), message.topic) != names.end();
           }) >= static_cast<std::ptrdiff_t>(count);
  });
}

}  // namespace sonopose::test
