#include "server/jobs/store_clock.h"

namespace remesh::server::jobs {

void shift_times(Database& database, std::int64_t by_ms) {
  database.run(
      "UPDATE remeshd_job SET created_ms = created_ms + $1, queued_ms = queued_ms + $1, started_ms = started_ms + $1, "
      "lease_ms = lease_ms + $1, finished_ms = finished_ms + $1, expires_ms = expires_ms + $1",
      {by_ms});
  database.run("UPDATE remeshd_idempotency SET expires_ms = expires_ms + $1", {by_ms});
}

}  // namespace remesh::server::jobs
