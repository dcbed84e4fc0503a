#pragma once
/// \file
/// Pictures drawn by gnuplot, whole or not at all. Private to this room.

#include "files/replacement.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace sonopose::plots {

/// Throws PictureError for an ending other than .svg and .png, a line break in the name, and where gnuplot is
/// not installed; files::IoError where `replacement` cannot be written.
void check_picture(const std::filesystem::path& file, const files::Replacement& replacement);

/// Runs the commands, which must draw into `replacement.part()`, and puts the picture in the file's place.
/// Throws PictureError where gnuplot fails; the file then stays as it was.
void draw_picture(const std::filesystem::path& file, files::Replacement& replacement, const std::string& script);

/// Text as gnuplot takes it literally, on one line.
std::string plot_text(std::string_view text);

}  // namespace sonopose::plots
