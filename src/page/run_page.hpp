#pragma once
/// \file
/// A run, or two that are compared, as one page for a browser that needs nothing else.

#include "files/replacement.hpp"
#include "plots/plot.hpp"

#include <filesystem>
#include <string>

namespace sonopose::page {

/// Of a page: finer than a pixel of an hour, and small as text.
inline constexpr plots::Detail detail{.moments = 16'384, .path_points = 32'768, .fixes = 16'384};

/// The data as JSON: columns of numbers, null where a value is not known.
std::string run_json(const plots::PlotData& data);

class RunPage {
public:
  /// `file` becomes the page. Throws files::IoError if it cannot be written, or if the plotting library is
  /// not installed: the message names the package. `log` must outlive the page.
  RunPage(const std::filesystem::path& file, std::string title, const recording::SensorLog& log);

  /// Begins a run, which is filled through the reference that is returned. `engine` is its name if it is not
  /// that of the settings.
  plots::RunCurves& add_run(std::string name, const settings::Settings& settings,
                            const std::string& engine = {});

  /// Replaces the file. Throws files::IoError.
  void write();

private:
  files::Replacement replacement_;
  const recording::SensorLog& log_;
  plots::PlotData data_;
  std::string library_;        ///< dygraphs
  std::string library_style_;  ///< its style sheet
};

}  // namespace sonopose::page
