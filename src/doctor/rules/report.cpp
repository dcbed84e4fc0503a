#include "doctor/rules/report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace sonopose::doctor {
namespace {

auto count_of(const std::vector<Finding>& findings, Severity severity) {
  return std::count_if(findings.begin(), findings.end(),
                       [severity](const Finding& finding) { return finding.severity == severity; });
}

std::string number_of(std::ptrdiff_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

const char* text_of(Severity severity) {
  switch (severity) {
    case Severity::ok:
      return "ok";
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      return "error";
  }
  return "";
}

std::string report_of(std::vector<Finding> findings) {
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity < b.severity; });
  std::string text;
  for (const Finding& finding : findings) {
    text += fmt::format("{:<8} {}: {}\n", text_of(finding.severity), finding.subject, finding.what);
    if (!finding.remedy.empty()) text += fmt::format("         → {}\n", finding.remedy);
  }
  if (!any_wrong(findings)) return text + "nothing is wrong\n";
  return text + fmt::format("{}, {}\n", number_of(count_of(findings, Severity::error), "error"),
                            number_of(count_of(findings, Severity::warning), "warning"));
}

std::string json_of(const std::vector<Finding>& findings) {
  nlohmann::json json{{"wrong", any_wrong(findings)}, {"findings", nlohmann::json::array()}};
  for (const Finding& finding : findings) {
    json["findings"].push_back({{"severity", text_of(finding.severity)},
                                {"subject", finding.subject},
                                {"what", finding.what},
                                {"remedy", finding.remedy}});
  }
  return json.dump();
}

}  // namespace sonopose::doctor
