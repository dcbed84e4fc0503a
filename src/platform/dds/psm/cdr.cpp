#include <sonopose/dds/psm/cdr.hpp>

#include <dds/ddsi/ddsi_cdrstream.h>

#include <algorithm>
#include <limits>

namespace sonopose::dds {

namespace {

constexpr std::size_t header_bytes = 4;
constexpr std::uint32_t xcdr1 = 1;
/// Padding at the end of a serialized sample, to a multiple of 4 bytes.
constexpr std::uint32_t max_padding = 3;

}  // namespace

bool read_cdr(std::span<const std::byte> cdr, const dds_topic_descriptor_t& type, void* sample) {
  if (cdr.size() <= header_bytes || cdr.size() > std::numeric_limits<std::uint32_t>::max()) return false;
  const auto byte_order = std::to_integer<int>(cdr[1]);
  if (cdr[0] != std::byte{} || byte_order > 1) return false;
  const bool is_foreign = (byte_order == 1) != (std::endian::native == std::endian::little);
  // Copied because Cyclone DDS swaps the bytes in place.
  const auto* const first = reinterpret_cast<const char*>(cdr.data());
  std::vector<char> data(first + header_bytes, first + cdr.size());
  const auto size = static_cast<std::uint32_t>(data.size());
  std::uint32_t end = 0;
  if (dds_stream_normalize_data(data.data(), &end, size, is_foreign, xcdr1, type.m_ops) == nullptr)
    return false;
  if (size - end > max_padding) return false;  // a type with more fields
  dds_istream_t stream;
  dds_istream_init(&stream, size, data.data(), xcdr1);
  dds_stream_read(&stream, static_cast<char*>(sample), type.m_ops);
  return true;
}

std::vector<std::byte> write_cdr(const void* sample, const dds_topic_descriptor_t& type,
                                 std::endian byte_order) {
  const auto* const fields = static_cast<const char*>(sample);
  const bool is_little = byte_order == std::endian::little;
  dds_ostreamLE_t little;
  dds_ostreamBE_t big;
  if (is_little) {
    dds_ostreamLE_init(&little, 0, xcdr1);
    dds_stream_writeLE(&little, fields, type.m_ops);
  } else {
    dds_ostreamBE_init(&big, 0, xcdr1);
    dds_stream_writeBE(&big, fields, type.m_ops);
  }
  dds_ostream_t& written = is_little ? little.x : big.x;
  std::vector<std::byte> cdr(header_bytes + written.m_index);
  cdr[1] = std::byte{is_little};
  std::copy_n(reinterpret_cast<const std::byte*>(written.m_buffer), written.m_index,
              cdr.begin() + header_bytes);
  dds_ostream_fini(&written);
  return cdr;
}

}  // namespace sonopose::dds
