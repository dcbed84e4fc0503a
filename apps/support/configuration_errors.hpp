#pragma once
// Errors of other libraries that are mistakes in the configuration.

#include <exception>
#include <functional>

namespace sonopose::apps {

/// Lets run() return `wrong_configuration` for the errors of which `is_one` is true. Call it before run().
void count_as_configuration_error(std::function<bool(const std::exception&)> is_one);

}  // namespace sonopose::apps
