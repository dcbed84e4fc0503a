#include "log_option.hpp"

#include "choice.hpp"

namespace sonopose::apps {

Option add_log_option(CommandLine& app, logging::Level& level) {
  using logging::Level;
  return add_choice<Level>(app, "--log-level", level,
                           {{"debug", Level::debug},
                            {"info", Level::info},
                            {"warning", Level::warning},
                            {"error", Level::error}},
                           "Log only lines of this level and above")
      .group(log_group);
}

}  // namespace sonopose::apps
