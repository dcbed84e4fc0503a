#pragma once
/// \file
/// The exception of key stores.

#include <stdexcept>

namespace sonopose::security {

/// A key store, or a file of one, that cannot be used. The message names the file, the cause and the remedy.
class SecurityError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// A certificate or document whose time has not come, or a clock that is behind: it can be used later.
class NotYetValid : public SecurityError {
public:
  using SecurityError::SecurityError;
};

}  // namespace sonopose::security
