#include "server/jobs/schema.h"

#include <chrono>
#include <vector>

#include "server/jobs/row_values.h"

namespace remesh::server::jobs {
namespace {

/// The max time of all migrations together. Making indices of many jobs takes longer than any call waits.
constexpr std::chrono::minutes kMigration{30};

/// Each list holds the statements that lead from the previous version to this one. Never change a version that was
/// released.
const std::vector<std::vector<std::string>> kVersions{
    {
        "CREATE TABLE remeshd_job ("
        " id text PRIMARY KEY,"
        " owner text NOT NULL,"
        " state text NOT NULL,"
        " turn bigint NOT NULL,"  // jobs run in the order of (turn, created_ms, id): see SqlStore::next_turn
        " memory bigint NOT NULL,"
        " request text NOT NULL,"
        " token bigint NOT NULL DEFAULT 0,"
        " attempts int NOT NULL DEFAULT 0,"
        " commits int NOT NULL DEFAULT 0,"  // at most 1; counted so that tests can prove it
        " worker text NOT NULL DEFAULT '',"
        " stage text NOT NULL DEFAULT 'queued',"
        " fraction double precision NOT NULL DEFAULT 0,"
        " version bigint NOT NULL DEFAULT 1,"
        " created_ms bigint NOT NULL,"
        " started_ms bigint,"
        " lease_ms bigint,"  // for a running job: the time at which it counts as abandoned
        " finished_ms bigint,"
        " expires_ms bigint,"  // for a job that has ended
        " problem_status int NOT NULL DEFAULT 0,"
        " problem text NOT NULL DEFAULT '')",
        "CREATE INDEX remeshd_job_queue ON remeshd_job (turn, created_ms, id, memory) WHERE state = 'queued'",
        "CREATE INDEX remeshd_job_waiting ON remeshd_job (created_ms) WHERE state = 'queued'",
        "CREATE INDEX remeshd_job_running ON remeshd_job (lease_ms) WHERE state = 'running'",
        "CREATE INDEX remeshd_job_ended ON remeshd_job (expires_ms) WHERE expires_ms IS NOT NULL",
        "CREATE INDEX remeshd_job_owner ON remeshd_job (owner, created_ms)",
        // There is one row for each chunk, or a single row that names a file.
        "CREATE TABLE remeshd_blob ("
        " job text NOT NULL, kind text NOT NULL, part int NOT NULL, data bytea, file text,"
        " PRIMARY KEY (job, kind, part))",
        "CREATE TABLE remeshd_owner (owner text PRIMARY KEY, last_turn bigint NOT NULL)",
        "CREATE INDEX remeshd_owner_turn ON remeshd_owner (last_turn)",
        "CREATE TABLE remeshd_idempotency ("
        " owner text NOT NULL, key text NOT NULL, digest text NOT NULL, job text NOT NULL, expires_ms bigint NOT NULL,"
        " PRIMARY KEY (owner, key))",
        "CREATE INDEX remeshd_idempotency_end ON remeshd_idempotency (expires_ms)",
        "CREATE INDEX remeshd_idempotency_job ON remeshd_idempotency (job)",
    },
    {
        // Rows of an older daemon, which may run beside this one for a while, have no values here.
        "ALTER TABLE remeshd_job ADD COLUMN lease_length_ms bigint",
        "ALTER TABLE remeshd_job ADD COLUMN queued_ms bigint",  // since when the job has been waiting
        "ALTER TABLE remeshd_job ADD COLUMN stored bigint",     // bytes of the job's input, or of its results
        "ALTER TABLE remeshd_blob ADD COLUMN size bigint",      // of the whole blob; stands in its first row
        "DROP INDEX remeshd_job_waiting",
        "CREATE INDEX remeshd_job_waiting ON remeshd_job (coalesce(queued_ms, created_ms)) WHERE state = 'queued'",
        std::string("CREATE INDEX remeshd_job_damaged ON remeshd_job (id) WHERE ") + damaged_job(),
        // There is no index of the blobs: making it would read all of them, and all writes would wait meanwhile.
        std::string("CREATE INDEX remeshd_job_stored ON remeshd_job (owner, stored) WHERE ") + kJobWithBlobs,
    },
};

/// Output: nothing if there are no tables.
std::optional<std::int64_t> version_of(Database& database, const DatabaseDriver& driver) {
  // A role that may not create tables gets an error even if the table exists. So the existence of the table is tested
  // first.
  if (!driver.has_table(database, "remeshd_schema"))
    database.run("CREATE TABLE remeshd_schema (version int NOT NULL, touched_ms bigint NOT NULL)");
  const Rows rows = database.run("SELECT version FROM remeshd_schema");
  if (rows.empty()) return std::nullopt;
  return integer(rows[0][0]);
}

}  // namespace

void bring_schema_up_to_date(Database& database, const DatabaseDriver& driver) {
  Transaction transaction(database);
  driver.lock_schema(database);
  const std::optional<std::int64_t> found = version_of(database, driver);
  const auto newest = static_cast<std::int64_t>(kVersions.size());
  if (found.value_or(0) > newest) {
    throw StoreError("the store has version " + std::to_string(*found) + ", but this remeshd knows only version " +
                     std::to_string(newest) + ": a newer version of remeshd has written to it");
  }
  if (found == newest) return transaction.commit();
  database.extend_deadline(kMigration);
  for (std::int64_t version = found.value_or(0); version < newest; ++version) {
    for (const std::string& statement : kVersions[static_cast<std::size_t>(version)]) database.run(statement.c_str());
    for (const std::string& statement : driver.schema_statements(version + 1)) database.run(statement.c_str());
  }
  if (!found) {
    database.run("INSERT INTO remeshd_schema (version, touched_ms) VALUES ($1, 0)", {newest});
  } else {
    database.run("UPDATE remeshd_schema SET version = $1", {newest});
  }
  transaction.commit();
}

}  // namespace remesh::server::jobs
