#include "doctor/rules/report.hpp"

#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace sonopose::doctor::rules {
namespace {

/// Escapes names and texts of other processes, which findings have: each finding is one line.
void escape(std::vector<Finding>& findings) {
  for (Finding& finding : findings) {
    for (std::string* const text : {&finding.subject, &finding.what, &finding.remedy}) {
      *text = text::escaped(*text);
    }
  }
}

/// "1 error".
std::string count_text(const std::vector<Finding>& findings, Severity severity) {
  const auto count = std::count_if(findings.begin(), findings.end(), [severity](const Finding& finding) {
    return finding.severity == severity;
  });
  return text::count_text(static_cast<std::uint64_t>(count), text_of(severity));
}

/// Findings on one kind of subject.
struct Group {
  std::string kind;                                        ///< "beacon"
  std::map<std::string, std::vector<Finding>> by_subject;  ///< "beacon 7"
};

/// Adds a finding to the group of its kind that `fits`, or to a new one.
void add_to(std::vector<Group>& groups, const Finding& finding, const auto& fits) {
  const std::string kind = finding.subject.substr(0, finding.subject.find(' '));
  auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& each) {
    return each.kind == kind && fits(each.by_subject.begin()->second.front());
  });
  if (group == groups.end()) group = groups.insert(group, {kind, {}});
  group->by_subject[finding.subject].push_back(finding);
}

/// "beacon 7", "20 beacons".
std::string name_of(const Group& group) {
  const std::size_t count = group.by_subject.size();
  return count == 1 ? group.by_subject.begin()->first : text::count_text(count, group.kind);
}

/// "beacon 7: WHAT; WHAT", or "20 beacons" for several subjects.
std::string text_of(const Group& group) {
  std::string text = name_of(group);
  if (group.by_subject.size() > 1) return text;
  std::string separator = ": ";
  for (const Finding& finding : group.by_subject.begin()->second) {
    text += std::exchange(separator, "; ") + finding.what;
  }
  return text;
}

/// Formats one line for the findings without a problem. Of several subjects it leaves out those with one.
std::string line_of_ok(const std::vector<Finding>& findings) {
  std::vector<Group> groups;
  std::set<std::string> with_problem;
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::ok) add_to(groups, finding, [](const Finding&) { return true; });
    if (finding.severity >= Severity::warning) with_problem.insert(finding.subject);
  }
  std::string text;
  bool is_short = false;
  for (Group& group : groups) {
    if (group.by_subject.size() > 1) {
      std::erase_if(group.by_subject, [&](const auto& entry) { return with_problem.contains(entry.first); });
    }
    if (group.by_subject.empty()) continue;
    text += (text.empty() ? "" : "; ") + text_of(group);
    is_short = is_short || group.by_subject.size() > 1;
  }
  if (text.empty()) return text;
  return fmt::format("{:<8} {}{}\n", text_of(Severity::ok), text, is_short ? " (details: --verbose)" : "");
}

/// Problems, and notes without their repetition on other subjects.
std::vector<Finding> without_details(const std::vector<Finding>& findings) {
  std::vector<Group> notes;
  std::vector<Finding> rest;
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::note) {
      add_to(notes, finding, [&](const Finding& other) {
        return other.what == finding.what && other.remedy == finding.remedy;
      });
    } else if (finding.severity >= Severity::warning) {
      rest.push_back(finding);
    }
  }
  for (const Group& group : notes) {
    rest.push_back(group.by_subject.begin()->second.front());
    rest.back().subject = name_of(group);
  }
  return rest;
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

std::string report_of(std::vector<Finding> findings, bool is_verbose) {
  escape(findings);
  std::string text;
  if (!is_verbose) {
    text = line_of_ok(findings);
    findings = without_details(findings);
  }
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity < b.severity; });
  for (const Finding& finding : findings) {
    text += fmt::format("{:<8} {}: {}\n", text_of(finding.severity), finding.subject, finding.what);
    if (!finding.remedy.empty()) text += fmt::format("         → {}\n", finding.remedy);
  }
  if (!has_problems(findings)) return text + "no problems found\n";
  return text + fmt::format("{}, {}\n", count_text(findings, Severity::error),
                            count_text(findings, Severity::warning));
}

std::string json_of(std::vector<Finding> findings) {
  escape(findings);
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
