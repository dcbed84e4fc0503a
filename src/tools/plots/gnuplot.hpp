#pragma once
/// \file
/// Runs gnuplot and replaces the output file only if it succeeds.

#include "files/replacement.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace sonopose::plots {

/// Throws PlotError for an extension other than .svg and .png, for a line break in the name, and if gnuplot
/// is not installed. Throws files::IoError if `replacement` cannot be written.
void check_plot_file(const std::filesystem::path& file, const files::Replacement& replacement);

/// Runs the commands, which must draw to `replacement.part()`, and replaces the file. Throws PlotError if
/// gnuplot fails, and leaves the file unchanged.
void draw_plot(const std::filesystem::path& file, files::Replacement& replacement, const std::string& script);

/// Quotes text on one line so that gnuplot takes it literally.
std::string plot_text(std::string_view text);

}  // namespace sonopose::plots
