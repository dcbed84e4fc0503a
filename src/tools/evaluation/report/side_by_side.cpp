#include "evaluation/report/side_by_side.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::evaluation {

namespace {

std::string spread_text(const Change& change) {
  if (std::isnan(change.standard_error)) return "a single case shows no spread";
  return fmt::format("standard error {:.1f} percentage points, {} cases", 100.0 * change.standard_error,
                     change.cases);
}

nlohmann::ordered_json json_of(const Change& change) {
  if (change.cases == 0) return {};
  return {{"cases", change.cases}, {"change", change.mean}, {"standard_error", change.standard_error}};
}

}  // namespace

Change change_of(const std::vector<CostPair>& costs, bool has_truth) {
  std::vector<double> ratios;
  for (const CostPair& cost : costs) {
    if (cost.has_truth == has_truth) ratios.push_back(std::log(cost.second_m / cost.first_m));
  }
  if (ratios.empty()) return {};
  const auto count = static_cast<double>(ratios.size());
  double sum = 0.0;
  for (const double ratio : ratios) sum += ratio;
  const double mean = sum / count;
  double squares = 0.0;
  for (const double ratio : ratios) squares += (ratio - mean) * (ratio - mean);
  const double standard_error = ratios.size() < 2
                                    ? std::numeric_limits<double>::quiet_NaN()
                                    : std::exp(mean) * std::sqrt(squares / (count - 1.0) / count);
  return {ratios.size(), std::expm1(mean), standard_error};
}

std::string table_of(const std::vector<CostPair>& costs, const std::string& first,
                     const std::string& second) {
  std::size_t width = 22;
  for (const CostPair& cost : costs) width = std::max(width, cost.name.size());
  std::string text =
      fmt::format("A: {}\nB: {}\n\n{:<{}} {:>8} {:>8} {:>9}  of\n{:<{}} {:>8} {:>8} {:>9}\n", first, second,
                  "case", width, "A", "B", "change", "", width, "cm", "cm", "%");
  for (const CostPair& cost : costs) {
    text += fmt::format("{:<{}} {:>8.2f} {:>8.2f} {:>+9.1f}  {}\n", cost.name, width, 100.0 * cost.first_m,
                        100.0 * cost.second_m, 100.0 * cost.change(),
                        cost.has_truth ? "the error" : "the prediction error");
  }
  for (const bool has_truth : {true, false}) {
    const Change all = change_of(costs, has_truth);
    if (all.cases == 0) continue;
    text +=
        fmt::format("{:<{}} {:>8} {:>8} {:>+9.1f}  {}\n", has_truth ? "all with truth" : "all without truth",
                    width, "", "", 100.0 * all.mean, spread_text(all));
  }
  return text;
}

std::string json_of(const std::vector<CostPair>& costs, const std::string& first, const std::string& second) {
  auto cases = nlohmann::ordered_json::array();
  for (const CostPair& cost : costs) {
    cases.push_back({{"case", cost.name},
                     {"has_truth", cost.has_truth},
                     {"first_m", cost.first_m},
                     {"second_m", cost.second_m},
                     {"change", cost.change()}});
  }
  const nlohmann::ordered_json object{{"first", first},
                                      {"second", second},
                                      {"cases", std::move(cases)},
                                      {"with_truth", json_of(change_of(costs, true))},
                                      {"without_truth", json_of(change_of(costs, false))}};
  return object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace sonopose::evaluation
