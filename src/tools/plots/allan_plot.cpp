#include "plots/allan_plot.hpp"

#include "plots/gnuplot.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <string_view>
#include <utility>

namespace sonopose::plots {
namespace {

using calibration::fit::AllanNumbers;

// Colours that colour-blind readers can distinguish (Okabe and Ito).
constexpr std::array<std::string_view, 3> axis_colours{"#0072B2", "#D55E00", "#009E73"};
constexpr std::array<std::string_view, 3> names{"x", "y", "z"};

void append_curves(std::string& script, const evaluation::AllanResult& result) {
  auto out = std::back_inserter(script);
  for (std::size_t axis = 0; axis < result.report.curves.size(); ++axis) {
    fmt::format_to(out, "$curve{} << END\n", axis);
    for (const calibration::fit::AllanPoint& point : result.report.curves[axis]) {
      // A logarithmic scale cannot show a deviation of zero.
      if (!(point.deviation > 0.0)) continue;
      fmt::format_to(out, "{:.6g} {:.6g} {:.6g} {:.6g}\n", point.tau_s, point.deviation,
                     point.deviation * (1.0 - point.relative_error),
                     point.deviation * (1.0 + point.relative_error));
    }
    // gnuplot refuses an empty data block.
    fmt::format_to(out, "nan nan nan nan\nEND\n");
  }
}

/// Draws the curve with its error band, the line of white noise, and the bias instability.
void append_axis(std::string& script, std::size_t axis, const AllanNumbers& numbers) {
  auto out = std::back_inserter(script);
  const std::string_view colour = axis_colours[axis % 3];
  fmt::format_to(out,
                 "$curve{0} using 1:3:4 with filledcurves fc rgb '{1}' fs transparent solid 0.15 noborder "
                 "notitle, \\\n  $curve{0} using 1:2 with lines lw 2 lc rgb '{1}' title '{2}'",
                 axis, colour, names[axis % 3]);
  if (numbers.noise_density) {
    fmt::format_to(out, ", \\\n  {:.6g}/sqrt(x) with lines lw 1 dt 2 lc rgb '{}' notitle",
                   *numbers.noise_density, colour);
  }
  if (numbers.bias_instability_tau_s) {
    fmt::format_to(
        out,
        ", \\\n  '+' using ({:.6g}):({:.6g}) every ::0::0 with points pt 6 ps 1.6 lw 2 lc rgb '{}' notitle",
        *numbers.bias_instability_tau_s, 0.664 * *numbers.bias_instability, colour);
  }
}

void append_panel(std::string& script, const evaluation::AllanResult& result, std::size_t first,
                  std::string_view title, std::string_view unit) {
  script += fmt::format("set title {}\nset ylabel {}\nplot ", plot_text(title), plot_text(unit));
  for (std::size_t axis = first; axis < first + 3; ++axis) {
    if (axis > first) script += ", \\\n  ";
    append_axis(script, axis, result.report.numbers[axis]);
  }
  script += '\n';
}

std::string script_of(const evaluation::AllanResult& result, const std::filesystem::path& part,
                      const std::filesystem::path& ending) {
  std::string script;
  append_curves(script, result);
  script += fmt::format(
      "set terminal {} size 1200,560 font 'sans,12' background rgb 'white' noenhanced\nset output {}\n"
      "set datafile missing 'nan'\nset multiplot layout 1,2 title {} font 'sans,14' noenhanced\n"
      "set logscale xy\nset format x '%g'\nset format y '%.0e'\nset grid xtics ytics lt 1 lw 0.7 lc rgb "
      "'#E4E4E4'\nset tics nomirror\nset border 3 lc rgb '#444444'\nset key bottom left Left reverse "
      "horizontal samplen 1.6\nset xlabel 'cluster length [s]'\nset samples 200\nset xrange "
      "[{:.6g}:{:.6g}]\n",
      ending == ".png" ? "pngcairo" : "svg", plot_text(part.string()),
      plot_text("Allan deviation of " + result.log.string()), result.report.curves[0].front().tau_s,
      result.report.curves[0].back().tau_s);
  append_panel(script, result, 0, "gyroscope; dashed: noise density; circle: floor", "rad/s");
  append_panel(script, result, 3, "accelerometer", "m/s^2");
  return script + "unset multiplot\nunset output\n";
}

}  // namespace

AllanPlot::AllanPlot(std::filesystem::path file) : file_(std::move(file)), replacement_(file_) {
  check_plot_file(file_, replacement_);
}

void AllanPlot::draw(const evaluation::AllanResult& result) {
  draw_plot(file_, replacement_, script_of(result, replacement_.part(), file_.extension()));
}

}  // namespace sonopose::plots
