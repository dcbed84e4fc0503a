#include "plots/plot.hpp"

#include "evaluation/replay/run.hpp"
#include "evaluation/sample_log.hpp"
#include "files/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <iostream>

namespace plot_test {

using namespace sonopose;
using namespace sonopose::test;
using plots::Plot;

bool gnuplot_is_here() {
  if (std::system("gnuplot --version > /dev/null 2>&1") == 0) return true;
  std::cout << "skipped: no gnuplot; scripts/setup test installs it\n";
  return false;
}

void show(const recording::SensorLog& log, Plot& plot, const settings::Settings& settings = {}) {
  plots::RunCurves& curves = plot.add_run("fused", settings);
  const auto add = [&curves](const auto& sample) { curves.add(sample); };
  evaluation::run(log, {.settings = settings}, {add, add});
}

/// Sets PATH during its lifetime.
class Path {
public:
  explicit Path(const char* value) : before_(std::getenv("PATH")) { ::setenv("PATH", value, 1); }
  ~Path() { ::setenv("PATH", before_.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

private:
  std::string before_;
};

TEST_CASE("any file name and title can be plotted, with and without truth") {
  if (!gnuplot_is_here()) return;
  const TemporaryFolder folder;
  recording::SensorLog log = sample_log("outlier_bursts");
  const auto svg = folder / R"(it's a "path" $HOME `x` \n %s.svg)";
  const auto png = folder / "b.png";
  {
    Plot plot(svg, "a 'title' with \"quotes\"", log);
    show(log, plot);
    plot.draw();
  }
  log.truth.clear();
  {
    Plot plot(png, "without truth", log);
    show(log, plot);
    plot.draw();
  }
  const std::string drawn = read_text(svg);
  CHECK(drawn.find("</svg>") != std::string::npos);
  CHECK(drawn.find("position error [cm]") != std::string::npos);
  CHECK(drawn.find("a 'title'") != std::string::npos);
  CHECK(read_text(png).starts_with("\x89PNG"));
}

TEST_CASE("the legend has only what is drawn, and calls used outliers down-weighted") {
  if (!gnuplot_is_here()) return;
  const TemporaryFolder folder;
  const auto legend_has = [&](const recording::SensorLog& log, const std::string& word,
                              settings::EngineKind engine) {
    settings::Settings settings;
    settings.engine.engine = engine;
    Plot plot(folder / "legend.svg", "", log);
    show(log, plot, settings);
    plot.draw();
    return read_text(folder / "legend.svg").find(">" + word + "<") != std::string::npos;
  };
  const recording::SensorLog clean = sample_log("walk", 10.0);
  const recording::SensorLog bursts = sample_log("outlier_bursts");
  using settings::EngineKind;
  CHECK(legend_has(clean, "fix used", EngineKind::kalman));
  CHECK_FALSE(legend_has(clean, "stale", EngineKind::kalman));
  CHECK_FALSE(legend_has(clean, "rejected", EngineKind::kalman));
  CHECK(legend_has(bursts, "rejected", EngineKind::kalman));
  CHECK(legend_has(bursts, "down-weighted", EngineKind::documented));
}

TEST_CASE("every panel over time marks a silence of the IMU") {
  if (!gnuplot_is_here()) return;
  const TemporaryFolder folder;
  recording::SensorLog log = sample_log("walk", 12.0);
  const TimeNs begin_ns = available_at_ns(log.events.front());
  std::erase_if(log.events, [begin_ns](const Event& event) {
    const double time_s = seconds_between(begin_ns, available_at_ns(event));
    return std::holds_alternative<ImuSample>(event) && time_s > 8.0 && time_s < 10.0;
  });
  Plot plot(folder / "silence.svg", "", log);
  show(log, plot);
  plot.draw();
  const std::string drawn = read_text(folder / "silence.svg");
  std::size_t shades = 0;
  const std::string grey = "fill = 'rgb(221, 221, 221)'";
  for (std::size_t at = drawn.find(grey); at != std::string::npos; at = drawn.find(grey, at + 1)) ++shades;
  constexpr std::size_t panels = 8;  // error, along, left, z, yaw, speed, delay, weights
  CHECK(shades == panels + 1);       // and the legend
}

TEST_CASE("a run without poses and a run at a single point can be plotted") {
  if (!gnuplot_is_here()) return;
  const TemporaryFolder folder;
  const recording::SensorLog log = sample_log("rest", 0.05);  // before the first fix
  Plot empty(folder / "empty.png", "", log);
  empty.add_run("fused", {});
  CHECK_NOTHROW(empty.draw());
  Plot spot(folder / "spot.png", "", log);
  show(log, spot);
  CHECK_NOTHROW(spot.draw());
}

TEST_CASE("a plot that cannot be drawn is refused before the run") {
  const TemporaryFolder folder;
  const recording::SensorLog log = sample_log("rest", 0.05);
  CHECK_THROWS_WITH(Plot(folder / "a.pdf", "", log), Catch::Contains("ends in .svg or .png"));
  CHECK_THROWS_WITH(Plot(folder / "a\nb.svg", "", log), Catch::Contains("line break"));
  {
    const Path nowhere("/nowhere");
    CHECK_THROWS_WITH(Plot(folder / "a.svg", "", log), Catch::Contains("gnuplot-nox"));
  }
  if (!gnuplot_is_here()) return;
  CHECK_THROWS_AS(Plot(folder / "none/a.svg", "", log), files::IoError);
}

TEST_CASE("a plot has fewer bytes than a megabyte, however long the run is") {
  if (!gnuplot_is_here()) return;
  const TemporaryFolder folder;
  const recording::SensorLog log = sample_log("outages", 75);
  Plot plot(folder / "two.svg", "two", log);
  settings::Settings documented;
  documented.engine.engine = settings::EngineKind::documented;
  show(log, plot);
  show(log, plot, documented);
  plot.draw();
  CHECK(read_text(folder / "two.svg").size() < 1'000'000);
}

}  // namespace plot_test
