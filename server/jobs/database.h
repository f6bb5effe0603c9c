/// SQL databases as the job store uses them: the interface of one connection, and of the driver that hides the
/// differences between SQLite and PostgreSQL.
///
/// The SQL that the store runs is the common part of both dialects. Parameters are written $1, $2, .... The function
/// remeshd_now() returns the time of the store's clock in milliseconds.
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

/// Marks a parameter as binary data instead of text.
struct Bytes {
  std::string_view bytes;
};
/// A parameter of a statement. Text and bytes are views; the caller owns the memory.
using Value = std::variant<std::int64_t, double, std::string_view, Bytes>;
using Values = std::vector<Value>;

/// One row of a result. Each column is text or bytes; a column that is NULL has no value.
using Row = std::vector<std::optional<std::string>>;
using Rows = std::vector<Row>;

/// The connection was lost before anything was committed, so the same operation can be tried again.
class ConnectionBroken : public StoreError {
 public:
  using StoreError::StoreError;
};

/// One connection, to be used by one thread at a time.
/// Errors: StoreError.
class Database {
 public:
  virtual ~Database() = default;

  enum class Result { kText, kBytes };
  /// Runs one statement.
  /// Input: `result` - kBytes if the columns hold binary data.
  virtual Rows run(const char* sql, const Values& parameters = {}, Result result = Result::kText) = 0;

  /// Begins a transaction that will write. Every `begin` is followed by `commit` or `roll_back`.
  virtual void begin() = 0;
  virtual void commit() = 0;
  virtual void roll_back() noexcept = 0;

  /// Tells the waiting daemons that there is work. They are told when the transaction commits.
  virtual void announce() = 0;
};

/// A transaction that is rolled back at the end of its scope unless `commit` was called.
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
  /// The clause to append to a SELECT whose rows will be updated. It skips rows that another transaction has locked.
  virtual std::string_view skip_locked() const = 0;
  /// Statements that create the objects that only this kind of database needs, besides the common tables.
  virtual std::vector<std::string> schema_statements() const = 0;
  /// Locks the schema against all other connections until the transaction ends.
  virtual void lock_schema(Database& database) const = 0;
  /// Called once at each start, after the schema exists.
  virtual void prepare(Database& database) = 0;
  /// Writes one piece of a blob as rows that are numbered from `part` on. The driver chooses the size of a row to
  /// suit its engine, and makes at most `kPartsOfPiece` rows.
  /// Input: at most `kPiece` bytes.
  static constexpr std::int64_t kPartsOfPiece = 131;
  static constexpr std::size_t kPiece = kPartsOfPiece * 8000;
  virtual void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                            std::string_view bytes) = 0;
  /// Returns unused space to the file system. This is called repeatedly.
  virtual void tidy(Database& database) = 0;
  /// See JobStore::wait_for_work.
  virtual void wait_for_work(const Event& wake, Clock::time_point until) = 0;
  /// The largest number of connections that may be open at once.
  virtual std::size_t max_connections() const = 0;
};

/// Makes a driver for an SQLite file, which is created if it does not exist.
std::unique_ptr<DatabaseDriver> make_sqlite_driver(const std::string& path);
/// Makes a driver for a PostgreSQL server.
/// Input: a URL or a connection string in libpq's syntax.
/// Errors: std::invalid_argument - libpq cannot parse it.
std::unique_ptr<DatabaseDriver> make_postgres_driver(const std::string& url);

}  // namespace remesh::server::jobs
