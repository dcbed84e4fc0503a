#pragma once
/// \file
/// The exception of file and device access.

#include <stdexcept>

namespace sonopose::files {

/// A file, device or socket that cannot be used, or a file with invalid content. The message names it and the
/// cause.
class IoError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

}  // namespace sonopose::files
