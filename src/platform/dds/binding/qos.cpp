#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/qos.hpp>

#include <new>

namespace sonopose::dds {

Qos::Qos() : qos_(dds_create_qos()) {
  if (!qos_) throw std::bad_alloc();
}

Qos::Qos(const Qos& other) : Qos() {
  check("dds_copy_qos", dds_copy_qos(get(), other.get()));
}

Qos& Qos::operator=(const Qos& other) {
  if (this != &other) *this = Qos(other);
  return *this;
}

void Qos::merge(const Qos& over) {
  // dds_merge_qos sets only policies that its first argument lacks.
  Qos merged(over);
  dds_merge_qos(merged.get(), get());
  *this = std::move(merged);
}

}  // namespace sonopose::dds
