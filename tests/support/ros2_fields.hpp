#pragma once
/// \file
/// ROS 2 messages field by field in the order of the IDL, whose hashes are those of ROS 2 (type_hash_test).

#include <sonopose/idl/ros2/field_visitors.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <bit>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace sonopose::test {

/// Visits the fields of a message in order, compound fields recursively. A visitor has `number(x)`,
/// `text(characters)` and `length(sequence)`.
template <class Visitor, class Field>
void visit(Visitor& visitor, Field& field) {
  if constexpr (std::is_arithmetic_v<Field>) {
    visitor.number(field);
  } else if constexpr (std::is_same_v<Field, char*> || std::is_same_v<std::remove_extent_t<Field>, char>) {
    visitor.text(field);
  } else if constexpr (std::is_array_v<Field>) {
    for (auto& element : field) visit(visitor, element);
  } else if constexpr (requires { field._buffer; }) {
    visitor.length(field);
    for (std::uint32_t i = 0; i < field._length; ++i) visit(visitor, field._buffer[i]);
  } else {
    // The visitor passes const references to the fields of a non-const object.
    idl::visit_fields(field, [&visitor](const char*, const auto& each) {
      visit(visitor, const_cast<std::remove_cvref_t<decltype(each)>&>(each));  // NOLINT(*-const-cast)
    });
  }
}

/// Fills every field with a distinct value, special ones included. Allocates strings and sequences with
/// dds_alloc.
class Filler {
public:
  /// Takes the lengths of the sequences, in order, repeated cyclically.
  explicit Filler(std::vector<std::uint32_t> lengths = {2, 0, 1, 3}) : lengths_(std::move(lengths)) {}

  template <class Number>
  void number(Number& value) {
    static constexpr std::uint64_t awkward[]{
        0x7ff8dead0000beefULL, 0xfff8000000000123ULL,  // NaNs with a payload
        0x8000000000000000ULL, 0x0000000000000001ULL,  // -0, the smallest subnormal
        0xfff0000000000000ULL, 0x7fefffffffffffffULL,  // -infinity, the largest finite
    };
    ++count_;
    if constexpr (std::is_same_v<Number, double>) {
      const std::uint64_t ordinary = 0x3ff0000000000000ULL + 0x0102030405ULL * count_;
      value = std::bit_cast<double>(count_ % 3 == 0 ? awkward[count_ / 3 % 6] : ordinary);
    } else {
      const std::uint32_t bits = 0x81828384U + 0x01010101U * count_;  // signed values are negative
      value = static_cast<Number>(bits);
    }
  }

  void text(char*& value) { value = dds_string_dup(next_text().c_str()); }

  template <std::size_t n>
  void text(char (&value)[n]) {
    const std::string text = next_text().substr(0, n - 1);
    text.copy(value, text.size());
    value[text.size()] = '\0';
  }

  template <class Sequence>
  void length(Sequence& sequence) {
    const std::uint32_t n = lengths_[sequences_++ % lengths_.size()];
    const std::size_t bytes = n * sizeof(*sequence._buffer);
    sequence = {n, n, static_cast<decltype(sequence._buffer)>(n == 0 ? nullptr : dds_alloc(bytes)), true};
  }

private:
  /// Next text; the lengths cover all remainders modulo 8 and thus every padding. Has no quotation marks or
  /// line breaks.
  std::string next_text() {
    static const std::string texts[]{"map",   "",         "a", std::string(1000, 'x'), "hedge_7/imu_link",
                                     "Räume", "two words"};
    return texts[count_texts_++ % 7];
  }

  std::vector<std::uint32_t> lengths_;
  std::size_t sequences_ = 0;
  std::size_t count_texts_ = 0;
  std::uint32_t count_ = 0;
};

/// Prints all fields on one line in message order. Doubles are the 16 hexadecimal digits of their bits,
/// integers decimal, strings quoted; a sequence follows its [length].
class Describer {
public:
  template <class Number>
  void number(Number value) {
    if constexpr (std::is_same_v<Number, float>) {
      number(double{value});
    } else if constexpr (std::is_same_v<Number, double>) {
      out_ << ' ' << std::hex << std::setw(16) << std::setfill('0') << std::bit_cast<std::uint64_t>(value)
           << std::dec;
    } else {
      out_ << ' ' << +value;
    }
  }
  void text(const char* value) { out_ << " \"" << value << '"'; }
  template <class Sequence>
  void length(const Sequence& sequence) {
    out_ << " [" << sequence._length << ']';
  }

  [[nodiscard]] std::string line() const { return out_.str().substr(1); }

private:
  std::ostringstream out_;
};

/// A message as one line.
template <class Message>
std::string described(Message message) {  // shallow copy: the visitor does not change pointees
  Describer describer;
  visit(describer, message);
  return describer.line();
}

/// A message with distinct fields, whose strings and sequences the destructor frees.
template <class Message>
class Filled {
public:
  explicit Filled(Filler filler = Filler()) { visit(filler, message); }
  Filled(const Filled&) = delete;
  Filled& operator=(const Filled&) = delete;
  ~Filled() { dds_sample_free(&message, &dds::TopicTraits<Message>::descriptor(), DDS_FREE_CONTENTS); }

  Message message{};
};

}  // namespace sonopose::test
