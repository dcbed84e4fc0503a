#pragma once
// Reads the policies of OMG DDS-XML.

#include "dds/qos/xml_element.hpp"

#include <pugixml.hpp>

namespace sonopose::dds::qos::xml {

/// Reads the policies of `<datawriter_qos>`, `<datareader_qos>`, `<topic_qos>` or `<domainparticipant_qos>`
/// into `qos`, overriding what it contains.
void read_policies(const Source& source, const pugi::xml_node& element, Qos& qos);

/// Fails if the history is deeper than the resource limits allow.
void check_depth(const Source& source, const pugi::xml_node& element, const Qos& qos);

}  // namespace sonopose::dds::qos::xml
