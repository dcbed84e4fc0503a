#include "realtime_option.hpp"

#include "logging/log.hpp"

namespace sonopose::apps {

void add_realtime_option(CommandLine& app, int& priority) {
  app.add_flag(
         "--realtime{50}", priority,
         "Use real-time priority 50 (or --realtime=PRIORITY), lock the memory and keep the cores awake; "
         "reports and skips what the system refuses")
      .check(number_between(1, 99))
      .group(realtime_group);
}

process::Realtime realtime(int priority) {
  if (priority == 0) return {};
  process::Realtime realtime = process::apply_realtime(priority);
  for (const auto& line : realtime.applied()) logging::info("realtime: " + line);
  for (const auto& line : realtime.refused()) logging::warning("realtime: not applied: " + line);
  return realtime;
}

}  // namespace sonopose::apps
