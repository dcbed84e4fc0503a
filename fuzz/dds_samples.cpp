// Deserializes samples of every native topic and converts them to native types. Byte 0 selects the topic.

#include "cdr_type.hpp"
#include "support.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <array>
#include <tuple>

using namespace sonopose;
using namespace sonopose::fuzz;
namespace topics = sonopose::dds::topics;

namespace {

using Bytes = std::span<const std::uint8_t>;

/// Reads the bytes like a reader of the topic.
template <class T>
void read_as(Bytes bytes) {
  static const CdrType<T> type;
  std::ignore = sonopose::dds::CdrSample<T>(std::as_bytes(bytes)).get();  // as from a recording
  type.read(bytes, [](const T& sample) {
    if constexpr (!std::is_same_v<T, sonopose_ResetCommand>) {  // no native type
      const auto native = topics::from_idl(sample);
      std::ignore = topics::to_idl(native);  // throws if it does not fit
    }
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto readers = std::apply(
      []<class... T>(const topics::Entry<T>&...) {
        return std::array<void (*)(Bytes), sizeof...(T)>{read_as<T>...};
      },
      topics::all);
  if (size == 0) return 0;
  readers[data[0] % readers.size()]({data + 1, size - 1});
  return 0;
}
