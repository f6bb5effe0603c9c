/// The tables of the job store, and the migration of older versions.
#pragma once

#include <string>

#include "server/jobs/database.h"

namespace remesh::server::jobs {

/// The condition for rows of jobs that no daemon can have written: unknown states, and numbers that would overflow when
/// they are incremented. An index finds them.
inline constexpr const char* kOutOfRange =
    "id IS NULL OR state NOT IN ('queued', 'running', 'succeeded', 'failed', 'cancelled', 'expired')"
    " OR memory NOT BETWEEN 0 AND 9000000000000000000 OR token NOT BETWEEN 0 AND 9000000000000000"
    " OR attempts NOT BETWEEN 0 AND 1000000 OR commits NOT BETWEEN 0 AND 1000000"
    " OR version NOT BETWEEN 0 AND 9000000000000000 OR turn NOT BETWEEN -9000000000000000 AND 9000000000000000";
/// SQLite stores fractions in columns of whole numbers.
inline constexpr const char* kFraction =
    "memory <> CAST(memory AS bigint) OR token <> CAST(token AS bigint) OR attempts <> CAST(attempts AS bigint)"
    " OR commits <> CAST(commits AS bigint) OR version <> CAST(version AS bigint) OR turn <> CAST(turn AS bigint)";
/// The condition that a row is damaged. An index is defined with this text.
inline std::string damaged_job() { return std::string("(") + kOutOfRange + " OR " + kFraction + ")"; }
/// The condition that a row is sound, for a database that may store fractions in columns of integers or for one that
/// does not. PostgreSQL does not; with the tests for fractions it would expect hardly any row to pass, and would sort
/// all rows instead of reading the first one of an index.
inline std::string sound_job(bool keeps_fractions) {
  return "NOT " + (keeps_fractions ? damaged_job() : std::string("(") + kOutOfRange + ")");
}

/// Assignments that increment columns of a row that may be damaged. A number that cannot be incremented restarts.
inline constexpr const char* kNextVersion =
    "version = CASE WHEN version BETWEEN 0 AND 9000000000000000 THEN CAST(version AS bigint) + 1 ELSE 1 END";
inline constexpr const char* kNextToken =
    "token = CASE WHEN token BETWEEN 0 AND 9000000000000000 THEN CAST(token AS bigint) + 1 ELSE 1 END";
inline constexpr const char* kNextCommits =
    "commits = CASE WHEN commits BETWEEN 0 AND 1000000 THEN CAST(commits AS bigint) + 1 ELSE 1 END";

/// The condition for rows of jobs whose blobs count as stored. A daemon of an older version removes the blobs of other
/// jobs without updating `stored`. An index finds these rows.
inline constexpr const char* kJobWithBlobs = "stored > 0 AND state NOT IN ('cancelled', 'expired')";

/// Creates the tables, or migrates them to the newest version.
/// Holds:  many daemons may start at once. A migration may take longer than the deadline of the connection, which it
///         extends.
/// Errors: StoreError - also if a newer remeshd made the tables, or if this role may not make them.
void bring_schema_up_to_date(Database& database, const DatabaseDriver& driver);

}  // namespace remesh::server::jobs
