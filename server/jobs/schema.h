/// The tables of the job store, and the migration of older versions.
#pragma once

#include "server/jobs/database.h"

namespace remesh::server::jobs {

/// The condition for rows of jobs that nobody can have written: unknown states, and numbers that would overflow when
/// they are counted up. An index finds them.
inline constexpr const char* kDamagedJob =
    "(id IS NULL OR state NOT IN ('queued', 'running', 'succeeded', 'failed', 'cancelled', 'expired')"
    " OR memory NOT BETWEEN 0 AND 9000000000000000000 OR token NOT BETWEEN 0 AND 9000000000000000"
    " OR attempts NOT BETWEEN 0 AND 1000000 OR commits NOT BETWEEN 0 AND 1000000"
    " OR version NOT BETWEEN 0 AND 9000000000000000 OR turn NOT BETWEEN -9000000000000000 AND 9000000000000000"
    // SQLite stores fractions in columns of whole numbers.
    " OR memory <> CAST(memory AS bigint) OR token <> CAST(token AS bigint) OR attempts <> CAST(attempts AS bigint)"
    " OR commits <> CAST(commits AS bigint) OR version <> CAST(version AS bigint) OR turn <> CAST(turn AS bigint))";

/// Assignments that count up columns of a row that may be damaged. A number that cannot be counted up begins anew.
inline constexpr const char* kNextVersion =
    "version = CASE WHEN version BETWEEN 0 AND 9000000000000000 THEN CAST(version AS bigint) + 1 ELSE 1 END";
inline constexpr const char* kNextToken =
    "token = CASE WHEN token BETWEEN 0 AND 9000000000000000 THEN CAST(token AS bigint) + 1 ELSE 1 END";
inline constexpr const char* kNextCommits =
    "commits = CASE WHEN commits BETWEEN 0 AND 1000000 THEN CAST(commits AS bigint) + 1 ELSE 1 END";

/// The condition for rows of jobs whose blobs count as stored. A daemon of an older version removes the blobs of the
/// others without noting it. An index finds these rows.
inline constexpr const char* kJobWithBlobs = "stored > 0 AND state NOT IN ('cancelled', 'expired')";

/// Creates the tables, or migrates them to the newest version.
/// Holds:  many daemons may start at once. A migration may take longer than the deadline of the connection, which it
///         extends.
/// Errors: StoreError - also if a newer remeshd made the tables, or if this role may not make them.
void bring_schema_up_to_date(Database& database, const DatabaseDriver& driver);

}  // namespace remesh::server::jobs
