#include "evaluation/side_by_side.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::evaluation {

Change change_of(const std::vector<CostPair>& costs) {
  const auto count = static_cast<double>(costs.size());
  double sum = 0.0;
  double squares = 0.0;
  for (const CostPair& cost : costs) {
    const double ratio = std::log(cost.second_m / cost.first_m);
    sum += ratio;
    squares += ratio * ratio;
  }
  const double mean = sum / count;
  const double change = std::expm1(mean);
  if (costs.size() < 2) return {change, std::numeric_limits<double>::quiet_NaN()};
  const double variance = std::max(0.0, (squares - count * mean * mean) / (count - 1.0));
  return {change, std::exp(mean) * std::sqrt(variance / count)};
}

std::string table_of(const std::vector<CostPair>& costs, const std::string& first,
                     const std::string& second) {
  std::size_t width = 15;
  for (const CostPair& cost : costs) width = std::max(width, cost.name.size());
  std::string text =
      fmt::format("A: {}\nB: {}\n\n{:<{}} {:>8} {:>8} {:>9}  of\n{:<{}} {:>8} {:>8} {:>9}\n", first, second,
                  "case", width, "A", "B", "change", "", width, "cm", "cm", "%");
  for (const CostPair& cost : costs) {
    text += fmt::format("{:<{}} {:>8.2f} {:>8.2f} {:>+9.1f}  {}\n", cost.name, width, 100.0 * cost.first_m,
                        100.0 * cost.second_m, 100.0 * cost.change(),
                        cost.has_truth ? "the error" : "the prediction error");
  }
  const Change all = change_of(costs);
  const std::string spread = std::isnan(all.standard_error)
                                 ? "one case shows no spread"
                                 : fmt::format("±{:.1f} standard error", 100.0 * all.standard_error);
  return text +
         fmt::format("{:<{}} {:>8} {:>8} {:>+9.1f}  {}\n", "all", width, "", "", 100.0 * all.mean, spread);
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
  const Change all = change_of(costs);
  const nlohmann::ordered_json object{{"first", first},
                                      {"second", second},
                                      {"cases", std::move(cases)},
                                      {"change", all.mean},
                                      {"standard_error", all.standard_error}};
  return object.dump(2) + "\n";
}

}  // namespace sonopose::evaluation
