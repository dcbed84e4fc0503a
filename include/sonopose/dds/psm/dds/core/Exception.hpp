#pragma once
/// \file
/// The exceptions. Left out: InvalidDowncastError and InvalidDataError, which nothing here throws.

#include "types.hpp"

#include <dds/dds.h>

#include <stdexcept>
#include <string>

namespace dds::inline sonopose_psm::core {

/// Base of all exceptions of DDS. The derived ones are also of the standard library.
class Exception {
public:
  virtual ~Exception() = default;
  virtual const char* what() const noexcept = 0;

protected:
  Exception() = default;
  Exception(const Exception&) = default;
  Exception& operator=(const Exception&) = default;
};

namespace detail {
template <class Standard>
class StandardException : public Exception, public Standard {
public:
  explicit StandardException(const std::string& message) : Standard(message) {}
  const char* what() const noexcept override { return Standard::what(); }
};
}  // namespace detail

/// An error of no other kind.
struct Error : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct AlreadyClosedError : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct IllegalOperationError : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct ImmutablePolicyError : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct InconsistentPolicyError : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct InvalidArgumentError : detail::StandardException<std::invalid_argument> {
  using StandardException::StandardException;
};
struct NotEnabledError : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct OutOfResourcesError : detail::StandardException<std::runtime_error> {
  using StandardException::StandardException;
};
struct PreconditionNotMetError : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct TimeoutError : detail::StandardException<std::runtime_error> {
  using StandardException::StandardException;
};
struct UnsupportedError : detail::StandardException<std::logic_error> {
  using StandardException::StandardException;
};
struct NullReferenceError : detail::StandardException<std::runtime_error> {
  using StandardException::StandardException;
};

namespace detail {
/// Throws the exception for a negative code of Cyclone DDS.
[[noreturn]] void fail(const std::string& text, dds_return_t code);

/// Returns a good code. Otherwise throws the exception for it, which names the call.
dds_return_t check(const char* call, dds_return_t code);
dds_return_t check(const char* call, const std::string& about, dds_return_t code);
}  // namespace detail

}  // namespace dds::inline sonopose_psm::core
