#include "plots/plot.hpp"

#include "evaluation/run.hpp"
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
  std::cout << "skipped: no gnuplot\n";
  return false;
}

void show(const recording::SensorLog& log, Plot& plot) {
  evaluation::run(log, {},
                  {[&plot](const FusedPose& pose) { plot.add(pose); },
                   [&plot](const FixReport& report) { plot.add(report); }});
}

/// Sets PATH during its lifetime.
class Path {
public:
  explicit Path(const char* value) : before_(std::getenv("PATH")) { ::setenv("PATH", value, 1); }
  ~Path() { ::setenv("PATH", before_.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;
  Path(Path&&) = delete;
  Path& operator=(Path&&) = delete;

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

TEST_CASE("a run without poses and a run at a single point can be plotted") {
  if (!gnuplot_is_here()) return;
  const TemporaryFolder folder;
  const recording::SensorLog log = sample_log("rest", 0.05);  // before the first fix
  Plot empty(folder / "empty.png", "", log);
  CHECK_NOTHROW(empty.draw());
  Plot spot(folder / "spot.png", "", log);
  show(log, spot);
  CHECK_NOTHROW(spot.draw());
}

TEST_CASE("a long run is thinned to a bounded number of moments that keep the peaks") {
  if (!gnuplot_is_here()) return;
  const TemporaryFolder folder;
  recording::SensorLog log;
  ImuSample first;
  first.sensor_time_ns = 1;
  log.events.emplace_back(first);
  constexpr int poses = 50'000;
  for (const TimeNs time_ns : {TimeNs{1}, to_ns(0.01) * poses}) {
    log.truth.push_back({.time_ns = time_ns});
  }
  log.truth.insert(log.truth.begin() + 1, {.time_ns = to_ns(0.01) * 777});
  Plot plot(folder / "long.svg", "", log);
  for (int k = 0; k < poses; ++k) {
    FusedPose pose;
    pose.time_ns = k == 0 ? 1 : to_ns(0.01) * k;
    if (k == 777) {
      pose.position_world_m.x() = 3.0;
      pose.status = status_stale;
    }
    plot.add(pose);
  }
  const auto& moments = plot.data().moments;
  CHECK(moments.size() <= Plot::most_moments);
  CHECK(moments.size() > Plot::most_moments / 4);
  double worst_m = 0.0;
  std::size_t stale = 0;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    if (moments[k].error_m > worst_m) worst_m = moments[k].error_m;
    stale += (moments[k].status & status_stale) != 0 ? 1U : 0U;
    if (k > 0) REQUIRE(moments[k].time_s > moments[k - 1].time_s);
  }
  CHECK(worst_m == 3.0);
  CHECK(stale == 1);
  CHECK(moments.back().time_s == Approx(0.01 * (poses - 1)));
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

}  // namespace plot_test
