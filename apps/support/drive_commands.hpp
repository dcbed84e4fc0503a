#pragma once
// The commands of sonopose-calibrate that calibrate an installation from a drive.

#include "command_line.hpp"
#include "config_options.hpp"
#include "evaluation/calibration/drive_calibration.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace sonopose::apps {

class DriveCommands {
public:
  /// Adds the commands mount, delay, lever-arm, noise and all.
  explicit DriveCommands(CommandLine& app);

  /// Returns true if one of the commands was given.
  [[nodiscard]] bool is_given() const;

  /// Runs the given command. Returns the exit code.
  [[nodiscard]] int run() const;

private:
  struct Command {
    CommandLine app;
    std::vector<calibration::drive::Quantity> wanted;
  };

  void add(CommandLine& app, const char* name, const char* what,
           std::vector<calibration::drive::Quantity> wanted);
  [[nodiscard]] evaluation::DriveCalibration calibrated(const Command& command) const;

  std::vector<Command> commands_;
  std::vector<std::filesystem::path> logs_;
  ConfigOptions config_;
  std::optional<std::filesystem::path> out_;
  std::optional<std::filesystem::path> write_;
  std::optional<std::filesystem::path> plot_;
  std::optional<BeaconAddress> beacon_;
  bool json_ = false;
};

}  // namespace sonopose::apps
