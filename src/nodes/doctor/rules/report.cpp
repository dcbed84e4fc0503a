#include "doctor/rules/report.hpp"

#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace sonopose::doctor::rules {
namespace {

/// "1 error".
std::string count_text(const std::vector<Finding>& findings, Severity severity) {
  const auto count = std::count_if(findings.begin(), findings.end(), [severity](const Finding& finding) {
    return finding.severity == severity;
  });
  return text::count_text(static_cast<std::uint64_t>(count), text_of(severity));
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
  if (!has_problems(findings)) return text + "no problems found\n";
  return text + fmt::format("{}, {}\n", count_text(findings, Severity::error),
                            count_text(findings, Severity::warning));
}

std::string json_of(const std::vector<Finding>& findings) {
  nlohmann::json json{{"ok", !has_problems(findings)}, {"findings", nlohmann::json::array()}};
  for (const Finding& finding : findings) {
    json["findings"].push_back({{"severity", text_of(finding.severity)},
                                {"subject", finding.subject},
                                {"what", finding.what},
                                {"remedy", finding.remedy}});
  }
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);  // a text need not be UTF-8
}

}  // namespace sonopose::doctor::rules
