#include <fcntl.h>
#include <poll.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <ctime>
#include <fstream>
#include <thread>
#include <utility>

#include "server/jobs/database.h"

namespace remesh::server::jobs {
namespace {

/// How long a connection waits while another one writes, and how long it sleeps between attempts. SQLite's own busy
/// handler sleeps longer each time, which costs more than most transactions take.
constexpr std::chrono::seconds kBusyPatience{20};
constexpr std::chrono::microseconds kBusyNap{1000};
/// Number of free pages of 4 KiB that stay in the file for later use.
constexpr std::int64_t kKeptPages = 16384;
/// Interval between checks whether another process has written.
constexpr std::chrono::milliseconds kLook{100};

std::int64_t milliseconds_of(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1000 + time.tv_nsec / 1'000'000;
}

/// Returns an identifier of this start of the system, which is the same in all its containers.
/// Output: empty if it cannot be read.
std::string boot_id() {
  std::string id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
  return id;
}

/// A clock that is not affected when the system's clock is set. Its base is the system's time when the file was first
/// opened after the system started, or the last time stored in the file if that is later. From there it counts the
/// time that has passed. All processes that use the file are on one system, so they agree.
class FileClock {
 public:
  std::int64_t now_ms() const { return base_ms_ + milliseconds_of(CLOCK_BOOTTIME); }
  void set_base(std::int64_t base_ms) { base_ms_ = base_ms; }
  /// Computes the base after a restart of the system.
  static std::int64_t new_base(std::int64_t last_ms) {
    return std::max(milliseconds_of(CLOCK_REALTIME), last_ms) - milliseconds_of(CLOCK_BOOTTIME);
  }

 private:
  std::atomic<std::int64_t> base_ms_{milliseconds_of(CLOCK_REALTIME) - milliseconds_of(CLOCK_BOOTTIME)};
};

class SqliteDatabase final : public Database {
 public:
  SqliteDatabase(const std::string& path, FileClock& clock) {
    const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
    const int code = ::sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr);
    if (code != SQLITE_OK) {
      const std::string reason = handle_ == nullptr ? "out of memory" : ::sqlite3_errmsg(handle_);
      ::sqlite3_close(handle_);
      throw StoreError(path + ": " + reason);
    }
    try {
      set_up(clock);
    } catch (...) {
      ::sqlite3_close(handle_);
      throw;
    }
    close_to_others(path);
  }
  ~SqliteDatabase() override { ::sqlite3_close(handle_); }

  Rows run(const char* sql, const Values& parameters, Result) override {
    sqlite3_stmt* prepared = nullptr;
    check(::sqlite3_prepare_v2(handle_, sql, -1, &prepared, nullptr));
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(prepared, ::sqlite3_finalize);
    for (std::size_t i = 0; i < parameters.size(); ++i) bind(prepared, i, parameters[i]);
    Rows rows;
    for (;;) {
      const int code = ::sqlite3_step(prepared);
      if (code == SQLITE_DONE) return rows;
      if (code != SQLITE_ROW) fail(code);
      rows.push_back(row_of(prepared));
    }
  }

  void begin() override { run("BEGIN IMMEDIATE", {}, Result::kText); }
  void commit() override {
    try {
      run("COMMIT", {}, Result::kText);
    } catch (const StoreError&) {
      roll_back();  // a commit that finds no room leaves the transaction open
      throw;
    }
  }
  void roll_back() noexcept override {
    if (::sqlite3_get_autocommit(handle_) == 0) ::sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
  /// Nothing is needed: waiting daemons notice that the file has changed.
  void announce() override {}

 private:
  /// Only the owner may read the file, because it holds other people's meshes, whatever the permissions of its folder
  /// are. The mode is set by name: opening and closing the file here would release the locks that SQLite holds on it.
  static void close_to_others(const std::string& path) {
    for (const char* part : {"", "-wal", "-shm"}) ::chmod((path + part).c_str(), S_IRUSR | S_IWUSR);
  }

  void set_up(FileClock& clock) {
    check(::sqlite3_busy_handler(handle_, nap, nullptr));
    check(::sqlite3_create_function(handle_, "remeshd_now", 0, SQLITE_UTF8 | SQLITE_INNOCUOUS, &clock, give_now,
                                    nullptr, nullptr));
    // The first pragma affects new files only. It allows freed pages to be returned to the file system.
    for (const char* pragma : {"PRAGMA auto_vacuum=INCREMENTAL", "PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL",
                               "PRAGMA journal_size_limit=67108864", "PRAGMA temp_store=MEMORY"}) {
      set_patiently(pragma);
    }
  }

  /// If two connections set the journal mode of a new file at once, each may hold a lock that the other waits for.
  /// SQLite then tells one of them so immediately, without calling the busy handler.
  void set_patiently(const char* pragma) {
    for (int naps = 0;; ++naps) {
      try {
        run(pragma, {}, Result::kText);
        return;
      } catch (const StoreError&) {
        if (::sqlite3_errcode(handle_) != SQLITE_BUSY || nap(nullptr, naps) == 0) throw;
      }
    }
  }

  /// Output: 0 if it has waited long enough.
  static int nap(void*, int naps) {
    if (naps * kBusyNap > kBusyPatience) return 0;
    std::this_thread::sleep_for(kBusyNap);
    return 1;
  }

  static void give_now(sqlite3_context* context, int, sqlite3_value**) {
    ::sqlite3_result_int64(context, static_cast<FileClock*>(::sqlite3_user_data(context))->now_ms());
  }

  void bind(sqlite3_stmt* statement, std::size_t i, const Value& value) {
    // SQLite treats "$2" as a name, and numbers it by its first occurrence.
    const int place = ::sqlite3_bind_parameter_index(statement, ("$" + std::to_string(i + 1)).c_str());
    if (place == 0) return;
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      check(::sqlite3_bind_int64(statement, place, *integer));
    } else if (const auto* real = std::get_if<double>(&value)) {
      check(::sqlite3_bind_double(statement, place, *real));
    } else if (const auto* text = std::get_if<std::string_view>(&value)) {
      // A null pointer would be bound as NULL.
      check(::sqlite3_bind_text64(statement, place, text->empty() ? "" : text->data(), text->size(), SQLITE_STATIC,
                                  SQLITE_UTF8));
    } else {
      const std::string_view bytes = std::get<Bytes>(value).bytes;
      check(::sqlite3_bind_blob64(statement, place, bytes.empty() ? "" : bytes.data(), bytes.size(), SQLITE_STATIC));
    }
  }

  static Row row_of(sqlite3_stmt* statement) {
    Row row;
    for (int i = 0; i < ::sqlite3_column_count(statement); ++i) {
      if (::sqlite3_column_type(statement, i) == SQLITE_NULL) {
        row.emplace_back();
        continue;
      }
      const void* bytes = ::sqlite3_column_type(statement, i) == SQLITE_BLOB ? ::sqlite3_column_blob(statement, i)
                                                                             : ::sqlite3_column_text(statement, i);
      row.emplace_back(std::in_place, static_cast<const char*>(bytes == nullptr ? "" : bytes),
                       static_cast<std::size_t>(::sqlite3_column_bytes(statement, i)));
    }
    return row;
  }

  void check(int code) const {
    if (code != SQLITE_OK) fail(code);
  }
  [[noreturn]] void fail(int code) const {
    throw StoreError(std::string(::sqlite3_errmsg(handle_)) + " (" + ::sqlite3_errstr(code) + ")");
  }

  sqlite3* handle_ = nullptr;
};

class SqliteDriver : public DatabaseDriver {
 public:
  explicit SqliteDriver(std::string path) : path_(std::move(path)) {}

  std::unique_ptr<Database> connect() override { return std::make_unique<SqliteDatabase>(path_, clock_); }
  std::string_view skip_locked() const override { return ""; }
  std::vector<std::string> schema_statements() const override {
    return {"CREATE TABLE remeshd_clock (boot text NOT NULL, base_ms bigint NOT NULL)"};
  }
  void lock_schema(Database&) const override {}  // BEGIN IMMEDIATE has locked it already
  void prepare(Database& database) override {
    Transaction transaction(database);
    const std::string boot = boot_id();
    const Rows known = database.run("SELECT boot, base_ms FROM remeshd_clock");
    if (!known.empty() && known[0][0] == boot && !boot.empty()) {
      clock_.set_base(std::stoll(*known[0][1]));
      return;
    }
    const Rows last = database.run("SELECT touched_ms FROM remeshd_schema");
    const std::int64_t base = FileClock::new_base(std::stoll(last.at(0).at(0).value()));
    database.run("DELETE FROM remeshd_clock");
    database.run("INSERT INTO remeshd_clock (boot, base_ms) VALUES ($1, $2)", {std::string_view(boot), base});
    transaction.commit();
    clock_.set_base(base);
  }

  void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                    std::string_view bytes) override {
    database.run("INSERT INTO remeshd_blob (job, kind, part, data) VALUES ($1, $2, $3, $4)",
                 {job, kind, part, Bytes{bytes}});
  }

  void tidy(Database& database) override {
    // Free pages are reused. Only if there are many of them does the file shrink, a little at a time.
    const std::int64_t free_pages = std::stoll(database.run("PRAGMA freelist_count").at(0).at(0).value());
    if (free_pages > kKeptPages) database.run("PRAGMA incremental_vacuum(4096)");
  }

  void wait_for_work(const Event& wake, Clock::time_point until) override {
    // Only one thread waits at a time, because the daemon has one thread that claims.
    if (!watcher_) watcher_ = connect();
    do {
      if (wake.wait(std::min(until, Clock::now() + kLook))) return;
      const std::string version = watcher_->run("PRAGMA data_version").at(0).at(0).value();
      if (std::exchange(version_, version) != version) return;
    } while (Clock::now() < until);
  }

  std::size_t max_connections() const override { return 8; }

 private:
  const std::string path_;
  FileClock clock_;
  std::unique_ptr<Database> watcher_;
  std::string version_;
};

}  // namespace

std::unique_ptr<DatabaseDriver> make_sqlite_driver(const std::string& path) {
  return std::make_unique<SqliteDriver>(path);
}

}  // namespace remesh::server::jobs
