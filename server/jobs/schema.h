/// The tables of the job store, and the migration of older versions.
#pragma once

#include "server/jobs/database.h"

namespace remesh::server::jobs {

/// Creates the tables, or migrates them to the newest version.
/// Holds:  many daemons may start at once.
/// Errors: StoreError - also if a newer remeshd made the tables.
void bring_schema_up_to_date(Database& database, const DatabaseDriver& driver);

}  // namespace remesh::server::jobs
