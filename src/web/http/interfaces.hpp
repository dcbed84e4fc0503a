#pragma once
/// \file
/// The addresses of this machine.

#include "web/http/access.hpp"

#include <vector>

namespace sonopose::web::http {

/// Where a browser reaches the server: `endpoint`, or, if it is that of all interfaces, the address of each,
/// loopback last.
std::vector<Endpoint> reachable(const Endpoint& endpoint);

}  // namespace sonopose::web::http
