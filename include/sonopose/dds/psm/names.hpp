#pragma once
/// \file
/// The namespaces of the PSM within sonopose, so that its names are the same there: `dds::sub::DataReader`.

// They are declared here, since their headers may come later.
namespace dds::inline sonopose_psm {
namespace core {}
namespace domain {}
namespace pub {}
namespace sub {}
namespace topic {}
}  // namespace dds::inline sonopose_psm

namespace sonopose::dds {

namespace core = ::dds::core;
namespace domain = ::dds::domain;
namespace pub = ::dds::pub;
namespace sub = ::dds::sub;
namespace topic = ::dds::topic;
namespace policy = ::dds::core::policy;

}  // namespace sonopose::dds
