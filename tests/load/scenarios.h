/// The load scenarios. Each starts a daemon of its own, prints what it measured, and returns an exit code. Those that
/// measure times judge them if they are asked to; `./dev test`, which must pass on any machine, does not.
#pragma once

#include <cstddef>

namespace remesh::load {

/// Opens `connections` connections that send a byte now and then, and as many that read as slowly. They must not delay
/// anybody else.
int slow(std::size_t connections, bool judges_times);

/// Sends three times as many requests as the daemon can serve. It must go on serving as many as it can, and turn the
/// rest away at once.
int overload(double seconds, bool judges_times);

/// Sends `requests` requests, of which a tenth are broken and a tenth are cut off. Neither memory nor the number of
/// descriptors may grow, and /metrics must count all requests.
int soak(std::size_t requests);

}  // namespace remesh::load
