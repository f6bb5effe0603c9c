/// The code that the clocks of both kinds of databases have in common.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/jobs/database.h"

namespace remesh::server::jobs {

/// If a store's clock differs from the system's by more than this, it was set while one of them was wrong. The
/// difference is then too large to be removed gradually.
constexpr std::chrono::milliseconds kWrongClock = std::chrono::hours(24) * 30;

/// Shifts all times in the store by this many milliseconds. So the clock can be corrected, and yet no job seems to have
/// waited, and no result seems to have expired. To be called in a transaction.
/// Input: `timeout` - the time that the store may take for one of many statements.
void shift_times(Database& database, std::int64_t by_ms, std::chrono::milliseconds timeout);

}  // namespace remesh::server::jobs
