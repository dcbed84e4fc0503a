#pragma once
/// \file
/// Starts another program of the project in place of this one.

#include <string>
#include <vector>

namespace sonopose::launch {

/// Replaces this process by the program: the one next to this program, otherwise the one on PATH. Returns
/// only on failure, with the cause in errno; ENOENT if there is no such program.
void execute(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace sonopose::launch
