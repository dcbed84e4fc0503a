#include "plots/gnuplot.hpp"

#include "files/append_file.hpp"
#include "files/input_file.hpp"
#include "plots/plot.hpp"

#include <algorithm>
#include <cstdlib>

namespace sonopose::plots {
namespace {

namespace fs = std::filesystem;

bool gnuplot_is_installed() {
  const char* const variable = std::getenv("PATH");
  std::string_view path = variable == nullptr ? "/usr/bin:/bin" : variable;
  while (!path.empty()) {
    const std::size_t colon = std::min(path.find(':'), path.size());
    std::error_code ignored;
    if (fs::is_regular_file(fs::path(path.substr(0, colon)) / "gnuplot", ignored)) return true;
    path.remove_prefix(std::min(colon + 1, path.size()));
  }
  return false;
}

/// Quotes text as one word for the shell.
std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// A temporary folder for the commands and gnuplot's messages; the destructor removes it.
class WorkFolder {
public:
  WorkFolder() : name_{(fs::temp_directory_path() / "sonopose-plot-XXXXXX").string()} {
    if (::mkdtemp(name_.data()) == nullptr) throw PlotError(name_ + ": cannot be created");
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(name_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  [[nodiscard]] fs::path script() const { return fs::path(name_) / "plot.gnuplot"; }
  [[nodiscard]] fs::path messages() const { return fs::path(name_) / "messages.txt"; }

private:
  std::string name_;
};

}  // namespace

void check_plot_file(const fs::path& file, const files::Replacement& replacement) {
  if (file.extension() != ".svg" && file.extension() != ".png") {
    throw PlotError(file.string() + ": a plot ends in .svg or .png");
  }
  if (std::any_of(file.native().begin(), file.native().end(),
                  [](char c) { return c == '\n' || c == '\r'; })) {
    throw PlotError(file.string() + ": the name of a plot must not contain a line break");
  }
  if (!gnuplot_is_installed()) {
    throw PlotError("plots need gnuplot, which is not installed (Debian package gnuplot-nox)");
  }
  // Fails now if the file cannot be written.
  const files::AppendFile part(replacement.part(), files::AppendFile::Existing::replace);
}

void draw_plot(const fs::path& file, files::Replacement& replacement, const std::string& script) {
  const WorkFolder folder;
  files::write_whole(folder.script(), script);
  const std::string command =
      "gnuplot " + shell_word(folder.script().string()) + " 2> " + shell_word(folder.messages().string());
  const int status = std::system(command.c_str());
  std::error_code ignored;
  if (status != 0 || fs::file_size(replacement.part(), ignored) == 0) {
    // The file is missing if the shell was killed, or the disk is full.
    const std::string messages =
        fs::exists(folder.messages(), ignored) ? files::read_text(folder.messages()) : std::string();
    throw PlotError(file.string() + ": gnuplot could not draw it: " + messages);
  }
  replacement.commit();
}

std::string plot_text(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += c == '\n' || c == '\r' ? ' ' : c;
  }
  return result + "'";
}

}  // namespace sonopose::plots
