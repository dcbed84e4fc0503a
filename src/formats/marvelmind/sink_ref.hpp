#pragma once
/// \file
/// A reference to any callable that takes samples, without std::function's allocation.

#include <sonopose/samples/samples.hpp>

#include <concepts>
#include <memory>
#include <type_traits>

namespace sonopose::marvelmind {

template <typename Value>
class SinkRef;

/// A callable that takes values and is not a SinkRef itself.
template <typename Callable, typename Value>
concept SinkOf =
    std::invocable<Callable&, const Value&> && !std::same_as<std::remove_cvref_t<Callable>, SinkRef<Value>>;

/// Refers to a callable `void(const Value&)` that outlives the call it is passed to.
template <typename Value>
class SinkRef {
public:
  template <SinkOf<Value> Callable>
  SinkRef(Callable&& callable)  // NOLINT(bugprone-forwarding-reference-overload): not for copies
      : object_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))),
        call_([](void* object, const Value& value) {
          (*static_cast<std::remove_reference_t<Callable>*>(object))(value);
        }) {}

  void operator()(const Value& value) const { call_(object_, value); }

private:
  void* object_;
  void (*call_)(void*, const Value&);
};

using EventSink = SinkRef<Event>;

}  // namespace sonopose::marvelmind
