#include "server/jobs/store_clock.h"

#include <string>

namespace remesh::server::jobs {

namespace {

/// The number of rows that one statement changes, so that none takes long.
constexpr std::int64_t kRows = 2000;

/// The latest time that is valid, in milliseconds since 1970.
const std::string kLastTime = "9000000000000000";

/// Runs `UPDATE table SET changes` for all rows, in the order of `column`.
void update_all(Database& database, const std::string& table, const std::string& column, const char* changes,
                std::int64_t by_ms, std::chrono::milliseconds timeout) {
  const std::string end =
      "SELECT " + column + " FROM " + table + " WHERE " + column + " >= $1 ORDER BY " + column + " LIMIT 1 OFFSET $2";
  const std::string update = "UPDATE " + table + " SET " + changes + " WHERE " + column + " >= $2";
  std::string from;
  for (;;) {
    const Rows next = database.run(end.c_str(), {std::string_view(from), kRows});
    if (next.empty()) break;
    const std::string& until = next[0][0].value();
    if (until == from) break;  // more rows than that have the same value
    database.run((update + " AND " + column + " < $3").c_str(),
                 {by_ms, std::string_view(from), std::string_view(until)});
    database.extend_deadline(timeout);
    from = until;
  }
  database.run(update.c_str(), {by_ms, std::string_view(from)});
  database.extend_deadline(timeout);
}

}  // namespace

void shift_times(Database& database, std::int64_t by_ms, std::chrono::milliseconds timeout) {
  const auto shift = [](const std::string& column) {
    // A damaged time that would overflow must not prevent the shift of all other times.
    return column + " = CASE WHEN " + column + " BETWEEN -" + kLastTime + " AND " + kLastTime + " THEN " + column +
           " + $1 ELSE " + column + " END";
  };
  std::string changes;
  for (const char* column : {"created_ms", "queued_ms", "started_ms", "lease_ms", "finished_ms", "expires_ms"})
    changes += (changes.empty() ? "" : ", ") + shift(column);
  update_all(database, "remeshd_job", "id", changes.c_str(), by_ms, timeout);
  update_all(database, "remeshd_idempotency", "job", shift("expires_ms").c_str(), by_ms, timeout);
}

}  // namespace remesh::server::jobs
