/// SQL databases as the job store uses them: one connection, and what each kind does its own way.
///
/// The dialect is the common part of SQLite's and PostgreSQL's: parameters are $1, $2, ..., and the function
/// remeshd_now() gives the milliseconds of the store's clock.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

/// Bytes that are no text.
struct Bytes {
  std::string_view bytes;
};
/// Owned by whoever asks.
using Value = std::variant<std::int64_t, double, std::string_view, Bytes>;
using Values = std::vector<Value>;

/// A row's values as text or bytes; nothing for NULL.
using Row = std::vector<std::optional<std::string>>;
using Rows = std::vector<Row>;

/// The database went away before anything was committed: the same can be tried again.
class ConnectionBroken : public StoreError {
 public:
  using StoreError::StoreError;
};

/// One connection, for one thread at a time. Errors: StoreError.
class Database {
 public:
  virtual ~Database() = default;

  enum class Result { kText, kBytes };
  /// Runs one statement. Input: `result` - kBytes where the columns hold bytes.
  virtual Rows run(const char* sql, const Values& parameters = {}, Result result = Result::kText) = 0;

  /// A transaction that will write. Every `begin` is followed by `commit` or `roll_back`.
  virtual void begin() = 0;
  virtual void commit() = 0;
  virtual void roll_back() noexcept = 0;

  /// Tells the daemons that wait that there is work, once the transaction is committed.
  virtual void announce() = 0;
};

/// Commits when told, else rolls back.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) { database_.begin(); }
  ~Transaction() {
    if (is_open_) database_.roll_back();
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit() {
    is_open_ = false;
    database_.commit();
  }

 private:
  Database& database_;
  bool is_open_ = true;
};

class DatabaseDriver {
 public:
  virtual ~DatabaseDriver() = default;

  virtual std::unique_ptr<Database> connect() = 0;
  /// What stands behind a SELECT whose rows are to be changed: rows that others are changing are left out.
  virtual std::string_view skip_locked() const = 0;
  /// Statements that make what this kind needs besides the common tables.
  virtual std::vector<std::string> schema_statements() const = 0;
  /// Lets nobody else look at the schema until the transaction ends.
  virtual void lock_schema(Database& database) const = 0;
  /// After the schema is there, once a start.
  virtual void prepare(Database& database) = 0;
  /// Writes a piece of a blob as rows from `part` on, at most `kPartsOfPiece` of them, in the size that suits the
  /// engine.
  /// Input:  at most `kPiece` bytes.
  static constexpr std::int64_t kPartsOfPiece = 131;
  static constexpr std::size_t kPiece = kPartsOfPiece * 8000;
  virtual void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                            std::string_view bytes) = 0;
  /// Asked again and again: gives room back that is no longer needed.
  virtual void tidy(Database& database) = 0;
  /// See JobStore.
  virtual void wait_for_work(const Event& wake, Clock::time_point until) = 0;
  /// Connections that are open at once, at most.
  virtual std::size_t max_connections() const = 0;
};

/// A file, made where there is none.
std::unique_ptr<DatabaseDriver> make_sqlite_driver(const std::string& path);
/// Input: a URL or a connection string, as libpq takes it. Errors: std::invalid_argument - it is none.
std::unique_ptr<DatabaseDriver> make_postgres_driver(const std::string& url);

}  // namespace remesh::server::jobs
