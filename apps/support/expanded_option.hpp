#pragma once
// The option --max-expanded, common to all programs that read MCAP files.

#include "mcap/expansion.hpp"
#include "run.hpp"

#include <cstdint>

namespace sonopose::apps {

/// Adds --max-expanded, which applies to all files of the program.
inline void add_expanded_option(CommandLine& app) {
  app.add_option_function<double>(
         "--max-expanded", [](double bytes) { mcap::set_max_expanded(static_cast<std::uint64_t>(bytes)); },
         "Refuse an MCAP file that expands to more, such as 50GB [4GB, or 200 times its size if that is "
         "more]")
      .transform(size_between(1e6))
      .type_name("SIZE");
}

}  // namespace sonopose::apps
