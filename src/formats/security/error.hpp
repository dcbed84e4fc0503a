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

}  // namespace sonopose::security
