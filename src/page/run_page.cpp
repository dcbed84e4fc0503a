#include "page/run_page.hpp"

#include "files/csv_writer.hpp"
#include "files/error.hpp"
#include "page/assets.hpp"
#include "page/library.hpp"
#include "plots/layout.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <utility>

namespace sonopose::page {
namespace {

using Json = nlohmann::ordered_json;
using plots::FixMark;
using plots::Moment;
using plots::PathPoint;

/// One value of each entry, rounded to 0.1 mm and the like.
template <class Entry, class Value>
Json column(const std::vector<Entry>& entries, const Value& value) {
  constexpr double steps = 1e4;
  Json numbers = Json::array();
  for (const Entry& entry : entries) {
    const double number = value(entry);
    if (std::isfinite(number)) {
      numbers.push_back(std::round(number * steps) / steps);
    } else {
      numbers.push_back(nullptr);
    }
  }
  return numbers;
}

/// The position is known from the first fix on.
double placed(const Moment& moment, double value) {
  return moment.is_placed() ? value : plots::unknown;
}

/// Of the errors in x and y; instead of the covariance, which four decimals do not represent.
double correlation_xy(const Moment& moment) {
  const auto& covariance = moment.position_covariance_m2;
  return covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1));
}

Json json_of(const std::vector<Moment>& moments) {
  constexpr double degrees = 1.0 / geometry::radians_per_degree;
  const auto all = [&moments](const auto& value) { return column(moments, value); };
  const auto std_of = [](double variance) { return std::sqrt(variance); };
  return {{"t", all([](const Moment& m) { return m.time_s; })},
          {"x_m", all([](const Moment& m) { return placed(m, m.position_world_m.x()); })},
          {"y_m", all([](const Moment& m) { return placed(m, m.position_world_m.y()); })},
          {"z_m", all([](const Moment& m) { return placed(m, m.position_world_m.z()); })},
          {"z_std_m", all([&](const Moment& m) { return std_of(m.position_covariance_m2(2, 2)); })},
          {"std_x_m", all([&](const Moment& m) { return std_of(m.position_covariance_m2(0, 0)); })},
          {"std_y_m", all([&](const Moment& m) { return std_of(m.position_covariance_m2(1, 1)); })},
          {"correlation_xy", all(correlation_xy)},
          {"true_z_m", all([](const Moment& m) { return m.true_position_world_m.z(); })},
          {"yaw_deg", all([](const Moment& m) { return m.yaw_rad * degrees; })},
          {"yaw_std_deg", all([](const Moment& m) { return m.yaw_std_rad * degrees; })},
          {"true_yaw_deg", all([](const Moment& m) { return m.true_yaw_rad * degrees; })},
          {"speed_mps", all([](const Moment& m) { return placed(m, m.speed_mps); })},
          {"true_speed_mps", all([](const Moment& m) { return m.true_speed_mps; })},
          {"error_m", all([](const Moment& m) { return placed(m, m.error_m); })},
          {"last_fix_error_m", all([](const Moment& m) { return m.last_fix_error_m; })},
          {"trust", all([](const Moment& m) { return m.trust; })}};
}

Json json_of(const std::vector<PathPoint>& path) {
  const auto all = [&path](const auto& value) { return column(path, value); };
  return {{"x_m", all([](const PathPoint& p) { return p.position_world_m.x(); })},
          {"y_m", all([](const PathPoint& p) { return p.position_world_m.y(); })},
          {"true_x_m", all([](const PathPoint& p) { return p.true_position_world_m.x(); })},
          {"true_y_m", all([](const PathPoint& p) { return p.true_position_world_m.y(); })}};
}

Json json_of(const std::vector<FixMark>& fixes) {
  const auto all = [&fixes](const auto& value) { return column(fixes, value); };
  return {{"t", all([](const FixMark& f) { return f.time_s; })},
          {"x_m", all([](const FixMark& f) { return f.position_world_m.x(); })},
          {"y_m", all([](const FixMark& f) { return f.position_world_m.y(); })},
          {"innovation_m", all([](const FixMark& f) { return f.innovation_m; })},
          {"verdict", all([](const FixMark& f) { return double(f.verdict); })}};
}

/// Text of an element: names of files and beacons have any characters.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char each : text) {
    if (each == '&')
      result += "&amp;";
    else if (each == '<')
      result += "&lt;";
    else
      result += each;
  }
  return result;
}

}  // namespace

std::string run_json(const plots::PlotData& data) {
  Json runs = Json::array();
  for (const plots::RunCurves& run : data.runs) {
    runs.push_back({{"name", run.name()},
                    {"settings", run.settings_text()},
                    {"moments", json_of(run.moments())},
                    {"path", json_of(run.path())},
                    {"fixes", json_of(run.fixes())}});
  }
  const auto& arrivals = data.arrivals.fixes;
  const Json json{{"format", "sonopose-run"},
                  {"version", 1},
                  {"title", data.title},
                  {"has_truth", data.has_truth},
                  {"arrivals",
                   {{"t", column(arrivals, [](const auto& mark) { return mark.time_s; })},
                    {"delay_s", column(arrivals, [](const auto& mark) { return mark.delay_s; })}}},
                  {"runs", std::move(runs)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

RunPage::RunPage(const std::filesystem::path& file, std::string title, const recording::SensorLog& log)
    : replacement_(file),
      log_(log),
      library_(library_file("dygraph.min.js")),
      library_style_(library_file("dygraph.min.css")) {
  files::CsvWriter(replacement_.part(), files::CsvWriter::Existing::replace)
      .flush();  // fail now if the file cannot be written
  data_.title = std::move(title);
  data_.has_truth = !log.truth.empty();
  data_.arrivals = plots::arrivals_of(log);
}

plots::RunCurves& RunPage::add_run(std::string name, const settings::Settings& settings,
                                   const std::string& engine) {
  return data_.runs.emplace_back(std::move(name), settings, engine, log_, detail);
}

void RunPage::write() {
  std::string json = run_json(data_);
  // Nothing in a text may look like the end of the element.
  for (std::size_t at = json.find('<'); at != std::string::npos; at = json.find('<', at)) {
    json.replace(at, 1, "\\u003c");
  }
  const std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
      escaped(data_.title) + "</title>\n<style>\n" + library_style_ + "\n" + std::string(run_style) +
      "</style>\n</head>\n<body>\n<script>\n" + library_ +
      "\n</script>\n<script type=\"application/json\" id=\"run\">" + json + "</script>\n<script>\n" +
      std::string(run_script) + "</script>\n</body>\n</html>\n";
  {
    files::CsvWriter out(replacement_.part(), files::CsvWriter::Existing::replace);
    out.text(html);
    out.flush();
  }
  replacement_.commit();
}

}  // namespace sonopose::page
