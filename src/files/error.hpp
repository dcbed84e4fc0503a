#pragma once
/// \file
/// The one exception of this room.

#include <stdexcept>

namespace sonopose::files {

/// A file, device or socket that cannot be used, or a file whose content is wrong. The message names which
/// one and why.
class IoError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

}  // namespace sonopose::files
