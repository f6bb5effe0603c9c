/// The connections of a store to its database, which its threads share.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

#include "server/jobs/database.h"

namespace remesh::server::jobs {

class ConnectionPool {
 public:
  /// Makes a pool that has no connections yet.
  explicit ConnectionPool(DatabaseDriver& driver);

  /// Gives a connection for the use of one thread. The first one creates the schema or migrates it. If the server
  /// accepts no more connections, it waits for one of those that are open.
  /// Errors: StoreError - also when the deadline is over.
  std::unique_ptr<Database> take(const StoreDeadline& deadline);
  /// Takes a connection back, also after an error. Null means that the connection had to be closed.
  void give(std::unique_ptr<Database> database) noexcept;
  /// Closes all unused connections, because the server was most likely restarted.
  void close_idle();
  /// Makes the next connection create the schema again, because the tables no longer exist.
  void forget_schema();

 private:
  std::unique_ptr<Database> open(const StoreDeadline& deadline);
  void make_schema(Database& database);

  DatabaseDriver& driver_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Database>> idle_;
  std::size_t open_ = 0;
  bool has_schema_ = false;
  bool is_replaced_ = false;  ///< the database was replaced, and connections to the old one are still open
};

}  // namespace remesh::server::jobs
