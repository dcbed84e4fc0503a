#pragma once
/// \file
/// Addresses of this machine.

#include "web/http/access.hpp"

#include <vector>

namespace sonopose::web::http {

/// Endpoints at which a browser reaches the server: `endpoint`, or, if it stands for all interfaces, the
/// address of each, loopback last.
std::vector<Endpoint> reachable(const Endpoint& endpoint);

}  // namespace sonopose::web::http
