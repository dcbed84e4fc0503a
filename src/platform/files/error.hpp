#pragma once
/// \file
/// The exception of file and device access.

#include <stdexcept>

namespace sonopose::files {

/// An unusable file, device or socket, or a file with invalid content. The message names it and the cause.
class IoError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

}  // namespace sonopose::files
