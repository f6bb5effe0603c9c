/// The tables of the job store, and how older ones are brought up to date.
#pragma once

#include "server/jobs/database.h"

namespace remesh::server::jobs {

/// Makes the tables where there are none.
/// Holds:  many daemons may start at once.
/// Errors: StoreError - also where a newer remeshd made them.
void bring_schema_up_to_date(Database& database, const DatabaseDriver& driver);

}  // namespace remesh::server::jobs
