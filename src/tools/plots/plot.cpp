#include "plots/plot.hpp"

#include "plots/gnuplot.hpp"

#include <utility>

namespace sonopose::plots {

Plot::Plot(std::filesystem::path file, std::string title, const recording::SensorLog& log)
    : file_(std::move(file)), replacement_(file_), log_(log) {
  check_plot_file(file_, replacement_);
  data_.title = std::move(title);
  data_.has_truth = !log.truth.empty();
  data_.arrivals = arrivals_of(log);
}

RunCurves& Plot::add_run(std::string name, const settings::Settings& settings, const std::string& engine) {
  return data_.runs.emplace_back(std::move(name), settings, engine, log_);
}

void Plot::draw() {
  if (data_.runs.empty() || data_.runs.size() > 2) throw PlotError("a plot shows one or two runs");
  draw_plot(file_, replacement_, gnuplot_script(data_, replacement_.part(), file_.extension()));
}

}  // namespace sonopose::plots
