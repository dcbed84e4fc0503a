#include "plots/likelihood_plot.hpp"

#include "plots/gnuplot.hpp"
#include "plots/plot.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <iterator>
#include <utility>
#include <vector>

namespace sonopose::plots {
namespace {

using calibration::drive::DriveFit;
using calibration::drive::Quantity;
using calibration::drive::Value;

std::vector<Quantity> drawn(const evaluation::DriveCalibration& result) {
  std::vector<Quantity> quantities;
  for (const Quantity quantity : result.wanted) {
    if (!result.fit.curves.at(static_cast<std::size_t>(quantity)).empty()) quantities.push_back(quantity);
  }
  return quantities;
}

void append_panel(std::string& script, const DriveFit& fit, Quantity quantity) {
  const auto at = static_cast<std::size_t>(quantity);
  const evaluation::Display& as = evaluation::display_of(quantity);
  const Value& value = fit[quantity];
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$curve{} << END\n", at);
  for (const calibration::drive::CurvePoint& point : fit.curves.at(at)) {
    fmt::format_to(out, "{:.9g} {:.6g}\n", as.scale * point.value, point.log_likelihood);
  }
  fmt::format_to(
      out,
      "END\nset xlabel {}\nset object 1 rectangle from {:.9g}, graph 0 to {:.9g}, graph 1 fc rgb '#E6F0F7' "
      "fs solid noborder behind\n",
      plot_text(fmt::format("{} [{}]", as.name, as.unit)), as.scale * value.low, as.scale * value.high);
  fmt::format_to(out,
                 "plot $curve{0} using 1:2 with linespoints pt 7 ps 0.5 lw 2 lc rgb '#0072B2' notitle, \\\n  "
                 "-0.5*((x-{1:.9g})/{2:.9g})**2 with lines dt 2 lw 1 lc rgb '#888888' notitle\n",
                 at, as.scale * value.value,
                 as.scale * (value.high - value.low) / (2.0 * calibration::drive::interval_stds));
}

std::string script_of(const evaluation::DriveCalibration& result, const std::filesystem::path& part,
                      const std::filesystem::path& ending) {
  const auto quantities = drawn(result);
  const std::size_t columns = quantities.size() < 4 ? quantities.size() : 4;
  const std::size_t rows = (quantities.size() + columns - 1) / columns;
  const std::string title =
      "log-likelihood of " + text::first_of(result.logs.front().string(), result.logs.size());
  std::string script = fmt::format(
      "set terminal {} size {},{} font 'sans,11' background rgb 'white' noenhanced\nset output {}\n"
      "set multiplot layout {},{} title {} font 'sans,14' noenhanced\nset grid xtics ytics lt 1 lw 0.7 lc "
      "rgb '#E4E4E4'\n"
      "set tics nomirror\nset border 3 lc rgb '#444444'\nset yrange [-6:0.5]\nset samples 200\nset xtics "
      "autofreq\n"
      "set format x '%.4g'\nset xtics rotate by -30\n",
      ending == ".png" ? "pngcairo" : "svg", 380 * columns, 40 + 320 * rows, plot_text(part.string()), rows,
      columns, plot_text(title));
  for (const Quantity quantity : quantities) append_panel(script, result.fit, quantity);
  return script + "unset multiplot\nunset output\n";
}

}  // namespace

LikelihoodPlot::LikelihoodPlot(std::filesystem::path file) : file_(std::move(file)), replacement_(file_) {
  check_plot_file(file_, replacement_);
}

void LikelihoodPlot::draw(const evaluation::DriveCalibration& result) {
  if (drawn(result).empty())
    throw PlotError(file_.string() + ": none of these quantities has a likelihood curve");
  draw_plot(file_, replacement_, script_of(result, replacement_.part(), file_.extension()));
}

}  // namespace sonopose::plots
