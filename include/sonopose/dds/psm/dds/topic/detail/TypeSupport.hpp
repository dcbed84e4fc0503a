#pragma once
/// \file
/// Conversions between the classes of the IDL types and idlc's structs in C, which are on the wire. The
/// generator (idl/cxx) specialises TypeSupport for each struct:
///
///   using C = …;                                                 // idlc's struct
///   static const dds_topic_descriptor_t& descriptor();           // unless it is @nested
///   static void fields(auto& visit, auto& sample, auto& c);      // visit(name, sample.x(), c.x) …
///                                                                // (a bounded sequence: its bound, too)

#include "../../core/Entity.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace sonopose::dds {
/// Descriptor of a type that idlc generated. Specialise it with a static function `const
/// dds_topic_descriptor_t& descriptor()`. Its struct can then be the type of a topic.
template <class T>
struct TopicTraits;
}  // namespace sonopose::dds

namespace dds::inline sonopose_psm::topic::detail {

template <class T>
struct TypeSupport;

/// A struct of idlc that is itself the type of a topic (sonopose::dds::TopicTraits): nothing is converted.
template <class T>
concept Native = requires {
  sonopose::dds::TopicTraits<T>::descriptor();
};

template <Native T>
struct TypeSupport<T> {
  using C = T;
  static const dds_topic_descriptor_t& descriptor() { return sonopose::dds::TopicTraits<T>::descriptor(); }
};

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

// The arrays of the IDL are C arrays.
// NOLINTBEGIN(modernize-avoid-c-arrays)

/// Converts to the struct in C, which refers to the strings and numbers of the sample.
class ToC {
public:
  /// Throws InvalidArgumentError for what is longer than its bound, or a string with a zero byte.
  template <class A, class B>
  void operator()(const char* name, const A& a, B& b) {
    name_ = name;
    convert(a, b);
  }
  template <class A, class B>
  void operator()(const char* name, const std::vector<A>& a, B& b, std::uint32_t bound) {
    name_ = name;
    check_bound(a.size(), bound);
    convert(a, b);
  }

private:
  template <Plain A, class B>
  void convert(const A& a, B& b) {
    b = static_cast<B>(a);
  }
  void convert(const std::string& a, char*& b) {
    check_text(a);
    b = const_cast<char*>(a.c_str());  // a writer only reads it
  }
  template <std::size_t size>
  void convert(const std::string& a, char (&b)[size]) {
    check_bound(a.size(), size - 1);
    check_text(a);
    std::copy_n(a.c_str(), a.size() + 1, b);
  }
  template <class A, class B, std::size_t size>
  void convert(const std::array<A, size>& a, B (&b)[size]) {
    for (std::size_t i = 0; i < size; ++i) convert(a[i], b[i]);
  }
  template <class A, class B>
  void convert(const std::vector<A>& a, B& b) {
    using Element = std::remove_pointer_t<decltype(b._buffer)>;
    b._maximum = b._length = static_cast<std::uint32_t>(a.size());
    b._release = false;
    if constexpr (std::is_same_v<A, Element> && std::is_arithmetic_v<A> && !std::is_same_v<A, bool>) {
      b._buffer = const_cast<Element*>(a.data());
    } else {
      auto memory = std::make_shared<Element[]>(a.size());
      b._buffer = memory.get();
      for (std::size_t i = 0; i < a.size(); ++i) convert(static_cast<const A&>(a[i]), b._buffer[i]);
      memory_.push_back(std::move(memory));
    }
  }
  template <class A, class B>
  requires requires { typename TypeSupport<A>::C; }
  void convert(const A& a, B& b) { TypeSupport<A>::fields(*this, a, b); }

  void check_bound(std::size_t size, std::size_t bound) const {
    if (size <= bound) return;
    throw core::InvalidArgumentError(std::string(name_) + " has " + std::to_string(size) + " of at most " +
                                     std::to_string(bound) + " elements");
  }
  void check_text(const std::string& text) const {
    if (text.find('\0') == std::string::npos) return;
    throw core::InvalidArgumentError(std::string(name_) + " contains a zero byte");
  }

  const char* name_ = "";
  std::vector<std::shared_ptr<void>> memory_;
};

/// Copies from the struct in C.
class FromC {
public:
  template <class A, class B>
  void operator()(const char*, A& a, const B& b, std::uint32_t /*bound*/ = 0) {
    convert(a, b);
  }

private:
  template <Plain A, class B>
  void convert(A& a, const B& b) {
    a = static_cast<A>(b);
  }
  void convert(std::string& a, const char* b) {
    if (b == nullptr) {
      a.clear();
    } else {
      a = b;
    }
  }
  template <class A, class B, std::size_t size>
  void convert(std::array<A, size>& a, const B (&b)[size]) {
    for (std::size_t i = 0; i < size; ++i) convert(a[i], b[i]);
  }
  template <class A, class B>
  void convert(std::vector<A>& a, const B& b) {
    a.resize(b._length);
    for (std::size_t i = 0; i < a.size(); ++i) {
      if constexpr (std::is_same_v<A, bool>) {
        a[i] = b._buffer[i];
      } else {
        convert(a[i], b._buffer[i]);
      }
    }
  }
  template <class A, class B>
  requires requires { typename TypeSupport<A>::C; }
  void convert(A& a, const B& b) { TypeSupport<A>::fields(*this, a, b); }
};
// NOLINTEND(modernize-avoid-c-arrays)

/// A sample as a struct in C, while the sample lives unchanged.
template <class T>
class AsC {
public:
  explicit AsC(const T& sample) { TypeSupport<T>::fields(to_c_, sample, c_); }
  const typename TypeSupport<T>::C* get() const { return &c_; }

private:
  ToC to_c_;
  typename TypeSupport<T>::C c_{};
};

template <Native T>
class AsC<T> {
public:
  explicit AsC(const T& sample) : c_(&sample) {}
  const T* get() const { return c_; }

private:
  const T* c_;
};

/// Frees what Cyclone DDS put into a sample in C.
template <class T>
void free_contents(typename TypeSupport<T>::C& c) {
  if ((TypeSupport<T>::descriptor().m_flagset & DDS_TOPIC_FIXED_SIZE) != 0) return;
  dds_sample_free(&c, &TypeSupport<T>::descriptor(), DDS_FREE_CONTENTS);
  c = {};
}

template <class T>
void copy_from_c(const typename TypeSupport<T>::C& c, T& sample) {
  FromC from_c;
  TypeSupport<T>::fields(from_c, sample, c);
}

/// Sets the key fields of `key` to those of an instance of a reader or writer.
template <class T>
void read_key(dds_entity_t entity, const core::InstanceHandle& instance, T& key) {
  if constexpr (Native<T>) {
    core::detail::check("dds_instance_get_key", dds_instance_get_key(entity, instance.c_value(), &key));
  } else {
    typename TypeSupport<T>::C c{};
    core::detail::check("dds_instance_get_key", dds_instance_get_key(entity, instance.c_value(), &c));
    copy_from_c<T>(c, key);
    free_contents<T>(c);
  }
}

}  // namespace dds::inline sonopose_psm::topic::detail
