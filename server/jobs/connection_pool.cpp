#include "server/jobs/connection_pool.h"

#include <chrono>
#include <utility>

#include "server/jobs/schema.h"

namespace remesh::server::jobs {
namespace {

/// The pause between attempts to open one more connection while others are open.
constexpr std::chrono::milliseconds kPause{200};
/// The interval in which a waiting thread checks whether the daemon is stopping.
constexpr std::chrono::milliseconds kLookForConnection{50};

}  // namespace

ConnectionPool::ConnectionPool(DatabaseDriver& driver) : driver_(driver) { idle_.reserve(driver.max_connections()); }

std::unique_ptr<Database> ConnectionPool::take(const StoreDeadline& deadline) {
  Clock::time_point next_attempt{};
  std::unique_lock lock(mutex_);
  for (;;) {
    while (!idle_.empty()) {
      std::unique_ptr<Database> database = std::move(idle_.back());
      idle_.pop_back();
      if (driver_.is_current(*database)) {
        database->set_deadline(deadline);
        return database;
      }
      database.reset();
      --open_;
      has_schema_ = false;
      is_replaced_ = true;
    }
    if (open_ == 0) is_replaced_ = false;
    // A new database is opened only after the last connection to the old one is closed.
    if (!is_replaced_ && open_ < driver_.max_connections() && Clock::now() >= next_attempt) {
      ++open_;
      lock.unlock();
      try {
        return open(deadline);
      } catch (const StoreError&) {
        lock.lock();
        --open_;
        // The server may accept no more connections from this daemon. Then the open ones are shared.
        if (open_ == 0 || deadline.is_over()) throw;
        next_attempt = Clock::now() + kPause;
      } catch (...) {
        lock.lock();
        --open_;
        throw;
      }
      continue;
    }
    if (deadline.is_over()) throw StoreError("all connections to the store are in use");
    returned_.wait_for(lock, deadline.left(kLookForConnection));
  }
}

std::unique_ptr<Database> ConnectionPool::open(const StoreDeadline& deadline) {
  bool has_schema = false;
  {
    const std::lock_guard lock(mutex_);
    has_schema = has_schema_;
  }
  std::unique_ptr<Database> database = driver_.connect_by(deadline);
  if (!has_schema) make_schema(*database);
  database->set_deadline(deadline);  // a migration extends this deadline
  return database;
}

void ConnectionPool::make_schema(Database& database) {
  bring_schema_up_to_date(database, driver_);
  driver_.prepare(database);
  const std::lock_guard lock(mutex_);
  has_schema_ = true;
}

void ConnectionPool::give(std::unique_ptr<Database> database) noexcept {
  {
    const std::lock_guard lock(mutex_);
    if (database && !database->is_usable()) database.reset();
    if (database && !driver_.is_current(*database)) {
      database.reset();
      is_replaced_ = true;
      has_schema_ = false;
    }
    if (database) {
      idle_.push_back(std::move(database));
    } else {
      --open_;
    }
  }
  returned_.notify_one();
}

void ConnectionPool::close_idle() {
  std::vector<std::unique_ptr<Database>> closed;
  closed.reserve(driver_.max_connections());
  const std::lock_guard lock(mutex_);
  open_ -= idle_.size();
  closed.swap(idle_);  // both have the memory that `give` needs
}

void ConnectionPool::forget_schema() {
  const std::lock_guard lock(mutex_);
  has_schema_ = false;
}

}  // namespace remesh::server::jobs
