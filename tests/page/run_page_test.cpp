#include "page/run_page.hpp"

#include "evaluation/run.hpp"
#include "files/error.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

namespace run_page_test {

using namespace sonopose;
using Catch::Contains;
using nlohmann::json;
using sonopose::test::TemporaryFolder;

recording::SensorLog walk_log(double duration_s) {
  sim::Recording walk = sim::record(sim::find_scenario("walk"), {.seed = 3, .duration_s = duration_s});
  recording::SensorLog log;
  log.events = std::move(walk.events);
  log.truth = std::move(walk.truth);
  return log;
}

void run(const recording::SensorLog& log, plots::RunCurves& curves) {
  evaluation::run(log, {},
                  {[&](const FusedPose& pose) { curves.add(pose); },
                   [&](const FixReport& report) { curves.add(report); }});
}

/// The document in a page.
json document_of(const std::string& page) {
  const std::string begin = "id=\"run\">";
  const std::size_t at = page.find(begin);
  REQUIRE(at != std::string::npos);
  const std::size_t from = at + begin.size();
  return json::parse(page.substr(from, page.find("</script>", from) - from));
}

SCENARIO("a run becomes a page that needs nothing else") {
  GIVEN("a walk of twenty seconds in a folder with a hostile name") {
    const TemporaryFolder folder;
    const auto file = folder / "walk.html";
    const recording::SensorLog log = walk_log(20);
    const std::string title = "a</script><img src=x onerror=alert(1)>\"&";
    WHEN("two runs of it are written") {
      page::RunPage page(file, title, log);
      run(log, page.add_run("first", {}));
      run(log, page.add_run("second", {}));
      page.write();
      const std::string text = test::read_text(file);
      THEN("nothing is fetched, and no text becomes a part of the page") {
        CHECK(text.find("<img") == std::string::npos);
        CHECK(text.find(" src=\"") == std::string::npos);
        CHECK(text.find("<link") == std::string::npos);
        CHECK_THAT(text, Contains("Dygraph") && Contains("<title>a&lt;/script>"));
      }
      THEN("it has path, fixes and settings of both, near the truth") {
        const json document = document_of(text);
        CHECK(document["title"] == title);
        CHECK(document["has_truth"] == true);
        REQUIRE(document["runs"].size() == 2);
        CHECK(document["runs"][1]["name"] == "second");
        CHECK_THAT(document["runs"][0]["settings"].get<std::string>(), Contains("kalman"));
        const json& moments = document["runs"][0]["moments"];
        CHECK(moments["t"].size() == 2000);
        for (const auto& [name, column] : moments.items()) {
          CAPTURE(name);
          CHECK(column.size() == 2000);
        }
        CHECK(moments["error_m"].back() < 0.1);
        const json& path = document["runs"][0]["path"];
        const double dx_m = path["x_m"].back().get<double>() - path["true_x_m"].back().get<double>();
        CHECK(std::abs(dx_m) < 0.1);
        const json& fixes = document["runs"][0]["fixes"];
        CHECK(fixes["t"].size() > 150);
        CHECK(fixes["verdict"].size() == fixes["t"].size());
        CHECK_FALSE(fixes["innovation_m"].back().is_null());
      }
    }
    WHEN("it is not written") {
      { const page::RunPage page(file, title, log); }
      THEN("there is no file") {
        CHECK(std::filesystem::is_empty(folder.path()));
      }
    }
  }
  GIVEN("a folder that does not exist") {
    const recording::SensorLog log = walk_log(1);
    THEN("that is refused before the run") {
      CHECK_THROWS_AS(page::RunPage("/proc/none/walk.html", "walk", log), files::IoError);
    }
  }
}

SCENARIO("a fix without an innovation has none on the page") {
  GIVEN("a fix of low quality, which is rejected before its innovation is known") {
    const recording::SensorLog log = walk_log(1);
    plots::PlotData data;
    plots::RunCurves& curves = data.runs.emplace_back("fused", settings::Settings(), "", log, page::detail);
    FixReport fix;
    fix.applied_time_ns = available_at_ns(log.events.front());
    fix.flags = fix_low_quality;
    curves.add(fix);
    THEN("it is not shown as a perfect one") {
      const json document = json::parse(page::run_json(data));
      CHECK(document["runs"][0]["fixes"]["innovation_m"][0].is_null());
      CHECK(document["runs"][0]["fixes"]["verdict"][0] == 2);
    }
  }
}

SCENARIO("a pose has its horizontal ellipse on the page") {
  GIVEN("a pose with standard deviations of 20 and 10 cm, and a large one of the height") {
    const recording::SensorLog log = walk_log(1);
    plots::PlotData data;
    plots::RunCurves& curves = data.runs.emplace_back("fused", settings::Settings(), "", log, page::detail);
    FusedPose pose;
    pose.time_ns = available_at_ns(log.events.front());
    Covariance<6>::Matrix covariance = Covariance<6>::Matrix::Identity();
    covariance(0, 0) = 0.04;
    covariance(1, 1) = 0.01;
    covariance(0, 1) = covariance(1, 0) = 0.5 * 0.2 * 0.1;
    pose.pose_covariance = Covariance<6>::from_matrix(covariance);
    curves.add(pose);
    THEN("they are those of x and y, with their correlation") {
      const json document = json::parse(page::run_json(data));
      const json& moments = document["runs"][0]["moments"];
      CHECK(moments["std_x_m"][0].get<double>() == Approx(0.2));
      CHECK(moments["std_y_m"][0].get<double>() == Approx(0.1));
      CHECK(moments["correlation_xy"][0].get<double>() == Approx(0.5));
    }
  }
}

SCENARIO("the page of an hour can be mailed") {
  GIVEN("an hour of poses at 100 Hz and of fixes at 16 Hz") {
    const recording::SensorLog log = walk_log(1);
    plots::PlotData data;
    data.title = "hour";
    plots::RunCurves& curves = data.runs.emplace_back("fused", settings::Settings(), "", log, page::detail);
    const TimeNs begin_ns = available_at_ns(log.events.front());
    Covariance<6>::Matrix matrix = 1.2345e-3 * Covariance<6>::Matrix::Identity();
    matrix(0, 1) = matrix(1, 0) = 0.3456e-3;
    const auto covariance = Covariance<6>::from_matrix(matrix);
    for (int i = 0; i < 360'000; ++i) {
      FusedPose pose;
      pose.time_ns = begin_ns + i * TimeNs{10'000'000};
      const double phase = 1e-3 * i;
      pose.position_world_m = {10.12345 * std::cos(phase), -7.54321 * std::sin(3 * phase), 1.23456};
      pose.trust = 0.98765;
      pose.pose_covariance = covariance;
      curves.add(pose);
      if (i % 6 != 0) continue;
      FixReport fix;
      fix.applied_time_ns = pose.time_ns;
      fix.position_world_m = pose.position_world_m;
      fix.innovation_world_m = {0.01234, -0.04321, 0.02345};
      fix.flags = fix_used;
      curves.add(fix);
    }
    THEN("its data are below 4 MB, so that the page is below 5 MB") {
      CHECK(page::run_json(data).size() < 4'000'000);
    }
  }
}

}  // namespace run_page_test
