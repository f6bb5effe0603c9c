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
#include "server/jobs/store_deadline.h"

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

/// The connection was lost before any commit, so the same operation can be tried again.
class ConnectionBroken : public StoreError {
 public:
  using StoreError::StoreError;
};

/// The tables do not exist, because the database was replaced by an empty one.
class SchemaMissing : public ConnectionBroken {
 public:
  using ConnectionBroken::ConnectionBroken;
};

/// One connection, to be used by one thread at a time.
/// Errors: StoreError; DataError - the store works, but cannot take these values.
class Database {
 public:
  virtual ~Database() = default;

  /// Sets the deadline of the statements that follow.
  void set_deadline(const StoreDeadline& deadline) { deadline_ = deadline; }
  /// Extends the deadline, see StoreDeadline::extend.
  void extend_deadline(std::chrono::milliseconds more) { deadline_.extend(more); }

  /// False if no statement can succeed any more.
  virtual bool is_usable() const { return true; }

  enum class Result { kText, kBytes };
  /// Runs one statement.
  /// Input: `result` - kBytes if the columns hold binary data.
  virtual Rows run(const char* sql, const Values& parameters = {}, Result result = Result::kText) = 0;
  /// Runs one statement, and returns whether its result has any row.
  bool finds(const char* sql, const Values& parameters) { return !run(sql, parameters).empty(); }

  /// Begins a transaction that will write. Every `begin` is followed by `commit` or `roll_back`.
  virtual void begin() = 0;
  virtual void commit() = 0;
  virtual void roll_back() noexcept = 0;

  /// Tells the waiting daemons, when the transaction commits, that there is work.
  virtual void announce() = 0;

 protected:
  explicit Database(const StoreDeadline& deadline) : deadline_(deadline) {}
  const StoreDeadline& deadline() const { return deadline_; }

 private:
  StoreDeadline deadline_;
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

/// The purpose for which room is asked.
enum class RoomFor { kNewJob, kResult };

class DatabaseDriver {
 public:
  virtual ~DatabaseDriver() = default;

  /// Opens a connection whose statements have the same deadline, until another one is set.
  virtual std::unique_ptr<Database> connect_by(const StoreDeadline& deadline) = 0;
  /// Opens a connection without a deadline.
  std::unique_ptr<Database> connect();
  /// False if the connection leads to a database that is no longer the one at the driver's address.
  virtual bool is_current(const Database&) const { return true; }
  /// The clause to append to a SELECT whose rows will be updated. With it, the SELECT skips rows that another
  /// transaction has locked.
  virtual std::string_view skip_locked() const = 0;
  /// True if a column of whole numbers may hold a fraction.
  virtual bool keeps_fractions() const = 0;
  /// Statements that create the objects that only this kind of database needs, besides the common tables, in this
  /// version of the schema.
  virtual std::vector<std::string> schema_statements(std::int64_t version) const = 0;
  /// True if there is a table of this name.
  virtual bool has_table(Database& database, std::string_view name) const = 0;
  /// Locks the schema against all other connections until the transaction ends. The statements of this transaction may
  /// take as long as they need.
  virtual void lock_schema(Database& database) const = 0;
  /// Called once at each start, after the schema exists.
  virtual void prepare(Database& database) = 0;
  /// Writes one piece of a blob as rows that are numbered from `part` on. The driver chooses the size of a row to
  /// suit its engine, and makes at most `kPartsOfPiece` rows.
  /// Input: at most `kPiece` bytes; `size` - the size of the whole blob, which is stored with the first piece.
  static constexpr std::int64_t kPartsOfPiece = 131;
  static constexpr std::size_t kPiece = kPartsOfPiece * 8000;
  virtual void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                            std::string_view bytes, std::uint64_t size) = 0;
  /// The number of rows of a blob whose last row has the number `last`.
  virtual std::int64_t rows_of_blob(std::int64_t last) const = 0;
  /// Checks that there is room for a blob of this size, besides some room that stays free.
  /// Errors: RoomRefused.
  virtual void check_room(Database&, std::uint64_t, RoomFor) const {}
  /// Called after each operation. If room is scarce, it keeps the log short.
  virtual void after(Database&) const {}
  /// Cuts a write-ahead log whose contents are also in the file, or can be written there.
  /// Output: true if there may be more room now.
  virtual bool cut_log(Database&) const { return false; }
  /// Frees the room that is kept for deletions.
  /// Output: true if there was such room.
  virtual bool release_reserve() const { return false; }
  /// Lets the store's clock follow the system's clock. It is called repeatedly.
  virtual void keep_clock(Database& database) = 0;
  /// Returns unused space to the file system. It is called repeatedly.
  virtual void tidy(Database& database) = 0;
  /// See JobStore::wait_for_work.
  /// Input: `deadline` - for queries that the store has to answer at once.
  virtual void wait_for_work(const Event& wake, Clock::time_point until, const StoreDeadline& deadline) = 0;
  /// The largest number of connections that may be open at once.
  virtual std::size_t max_connections() const = 0;
};

/// Makes a driver for an SQLite file, which is created if it does not exist.
std::unique_ptr<DatabaseDriver> make_sqlite_driver(const std::string& path);
/// Makes a driver for a PostgreSQL server.
/// Input: `url` - a URL or a connection string in libpq's syntax; `timeout` - after this time the server itself ends a
///        statement, so that no statement runs on for which no daemon waits; `password_file` - its first line is the
///        password, which is read anew for each connection; empty: the URL has the password, if there is one.
/// Errors: std::invalid_argument - libpq cannot parse it.
std::unique_ptr<DatabaseDriver> make_postgres_driver(const std::string& url,
                                                     std::chrono::milliseconds timeout = StoreRules().timeout,
                                                     const std::string& password_file = {});

}  // namespace remesh::server::jobs
