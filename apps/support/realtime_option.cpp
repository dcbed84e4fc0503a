#include "realtime_option.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace sonopose::apps {

void add_realtime_option(CLI::App& app, int& priority) {
  app.add_flag(
         "--realtime{50}", priority,
         "Use real-time priority 50 (or --realtime=PRIORITY), lock the memory and keep the cores awake; "
         "reports and skips what the system refuses")
      ->check(CLI::Range(1, 99))
      ->group(realtime_group);
}

process::Realtime realtime(const CLI::App& app, int priority) {
  if (priority == 0) return {};
  process::Realtime realtime = process::apply_realtime(priority);
  for (const auto& line : realtime.applied()) fmt::print(stderr, "{}: realtime: {}\n", app.get_name(), line);
  for (const auto& line : realtime.refused()) {
    fmt::print(stderr, "{}: realtime: not applied: {}\n", app.get_name(), line);
  }
  return realtime;
}

}  // namespace sonopose::apps
