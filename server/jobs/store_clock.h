/// The parts that the clocks of both kinds of databases have in common.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/jobs/database.h"

namespace remesh::server::jobs {

/// A store's clock that differs from the system's by more than this was set while one of them was wrong. The difference
/// is too large to wait until it is gone.
constexpr std::chrono::milliseconds kWrongClock = std::chrono::hours(24) * 30;

/// Shifts all times in the store by so many milliseconds. So a clock can be set right without that jobs seem to have
/// waited, or results to be out of date. To be called in a transaction.
/// Input: `timeout` - how long the store may take for one of many statements.
void shift_times(Database& database, std::int64_t by_ms, std::chrono::milliseconds timeout);

}  // namespace remesh::server::jobs
