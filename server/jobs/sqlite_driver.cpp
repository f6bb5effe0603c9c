#include <fcntl.h>
#include <poll.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "server/http/units.h"
#include "server/jobs/database.h"
#include "server/jobs/job_store.h"
#include "server/jobs/row_values.h"
#include "server/jobs/store_clock.h"

namespace remesh::server::jobs {
namespace {

class DiskReserve {
 public:
  /// Input: `folder` - a folder on the volume. The size of the reserve is 8 MiB, or a twentieth of a smaller volume.
  explicit DiskReserve(const std::string& folder) : folder_(folder), path_(folder + "/reserve") {}

  /// Makes the file, or makes it longer, as far as there is room. All room that becomes free goes into it first,
  /// because other programs may fill the volume at any time, and then nothing else is left for deletions.
  void keep() const noexcept;
  /// Makes the file shorter by a part of its size, so that this room can be used.
  /// Output: true if there was some.
  bool release() const noexcept;

  /// Checks that the volume has this much room besides the room that stays free: for deletions, and if a new job asks,
  /// also for the results of the existing jobs.
  /// Errors: RoomRefused.
  void check_room(std::uint64_t bytes, RoomFor purpose) const;
  /// The bytes that are free on the volume.
  std::uint64_t free() const { return room().free; }
  /// True if there is so little room that unused room in files should be returned to the file system.
  bool is_scarce() const;

 private:
  struct Room {
    std::uint64_t free = 0;
    std::uint64_t reserve = 0;  ///< the size that the file should have
  };
  Room room() const;

  const std::string folder_;
  const std::string path_;
};

constexpr std::uint64_t kMaxReserve = 8 << 20;
constexpr std::uint64_t kShare = 20;  ///< the reserve is at most this part of the volume
constexpr std::uint64_t kParts = 4;   ///< so many times some of it can be released
constexpr std::uint64_t kLeast = 64 << 10;

std::uint64_t size_of(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

DiskReserve::Room DiskReserve::room() const {
  struct statvfs volume {};
  // If the system does not report the free space, there is no limit: then writing shows whether there is room.
  if (::statvfs(folder_.c_str(), &volume) != 0) return {~std::uint64_t{0} / 2, 0};
  const std::uint64_t block = volume.f_frsize;
  return {volume.f_bavail * block, std::min(kMaxReserve, volume.f_blocks * block / kShare)};
}

void DiskReserve::keep() const noexcept {
  const Room now = room();
  const std::uint64_t size = size_of(path_);
  if (size >= now.reserve) return;
  const std::uint64_t more = std::min(now.reserve - size, now.free);
  if (more < std::min(kLeast, now.reserve - size)) return;
  const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return;
  if (::posix_fallocate(file, static_cast<off_t>(size), static_cast<off_t>(more)) != 0 &&
      ::ftruncate(file, static_cast<off_t>(size)) != 0)
    ::unlink(path_.c_str());
  ::close(file);
}

bool DiskReserve::release() const noexcept {
  const std::uint64_t size = size_of(path_), part = std::max(kLeast, room().reserve / kParts);
  if (size > part) return ::truncate(path_.c_str(), static_cast<off_t>(size - part)) == 0;
  return ::unlink(path_.c_str()) == 0 && size > 0;
}

void DiskReserve::check_room(std::uint64_t bytes, RoomFor purpose) const {
  const Room now = room();
  // Storing a result ends a job and removes its input, so it may use all room except the reserve.
  const std::uint64_t for_deletions = now.reserve - std::min(now.reserve, size_of(path_));
  const std::uint64_t stays = purpose == RoomFor::kNewJob ? 2 * now.reserve : for_deletions;
  if (now.free >= stays && now.free - stays >= bytes) return;
  throw RoomRefused("the volume of " + folder_ + " has " + format_bytes(now.free) + " left");
}

bool DiskReserve::is_scarce() const {
  const Room now = room();
  return now.free < 8 * now.reserve;
}

/// How long a connection sleeps between attempts while another one writes. SQLite's own busy handler sleeps longer each
/// time, which costs more than most transactions take.
constexpr std::chrono::microseconds kBusyNap{1000};
/// Number of free pages of 4 KiB that stay in the file for later use.
constexpr std::int64_t kKeptPages = 16384;
constexpr std::uint64_t kPage = 4096;
/// A write-ahead log that is longer is written back and cut at the next occasion.
constexpr std::uint64_t kMaxLog = 8 << 20;
/// The log may be this long where room is scarce.
constexpr std::uint64_t kShortLog = 256 << 10;
/// The max number of pages that are moved at once, and how many times in a row if room is scarce.
constexpr std::int64_t kMoved = 4096;
constexpr int kRounds = 16;
/// The room that is taken from the reserve to move pages.
constexpr std::uint64_t kRoomToMove = 256 << 10;
/// Room for the rows that are written besides a blob.
constexpr std::uint64_t kSmallWrite = 256 << 10;
/// Interval between checks whether another process has written.
constexpr std::chrono::milliseconds kLookForChanges{100};

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
  std::int64_t base_ms() const { return base_ms_; }
  void set_base(std::int64_t base_ms) { base_ms_ = base_ms; }
  /// Computes the base after a restart of the system.
  /// Input: `last_ms` - the last time stored in the file; 0 if there is none.
  static std::int64_t new_base(std::int64_t last_ms) {
    const std::int64_t wall_ms = milliseconds_of(CLOCK_REALTIME);
    // If the system's clock was wrong before, all times are shifted when the clock is kept next.
    const bool was_wrong = last_ms > 0 && wall_ms - last_ms > kWrongClock.count();
    return (was_wrong ? last_ms : std::max(wall_ms, last_ms)) - milliseconds_of(CLOCK_BOOTTIME);
  }
  /// The difference between the system's clock and this one, positive if the system's clock is ahead.
  std::int64_t behind_ms() const { return milliseconds_of(CLOCK_REALTIME) - now_ms(); }

 private:
  std::atomic<std::int64_t> base_ms_{milliseconds_of(CLOCK_REALTIME) - milliseconds_of(CLOCK_BOOTTIME)};
};

class SqliteDatabase final : public Database {
 public:
  SqliteDatabase(const std::string& path, FileClock& clock, const StoreDeadline& deadline)
      : Database(deadline), path_(path) {
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
    file_ = file_at(path);
    log_ = file_at(path + "-wal");
  }
  ~SqliteDatabase() override {
    ::sqlite3_close(handle_);
    if (is_current()) return;
    // If the file was replaced, SQLite leaves the old file's write-ahead log. It must not be applied to the new file.
    if (log_ && log_ == file_at(path_ + "-wal")) {
      for (const char* part : {"-wal", "-shm"}) ::unlink((path_ + part).c_str());
    }
  }

  /// False if the file was deleted or replaced after it was opened.
  bool is_current() const { return file_ == file_at(path_); }

  Rows run(const char* sql, const Values& parameters, Result) override {
    sqlite3_stmt* prepared = nullptr;
    check(::sqlite3_prepare_v2(handle_, sql, -1, &prepared, nullptr));
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(prepared, ::sqlite3_finalize);
    for (std::size_t i = 0; i < parameters.size(); ++i) bind(prepared, i, parameters[i]);
    Rows rows;
    for (;;) {
      const int code = ::sqlite3_step(prepared);
      if (code == SQLITE_DONE) return rows;
      if (code != SQLITE_ROW) fail(::sqlite3_extended_errcode(handle_));
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
  /// No announcement is needed: waiting daemons notice that the file has changed.
  void announce() override {}

 private:
  /// Identifies a file independently of its name.
  using FileId = std::pair<::dev_t, ::ino_t>;
  static std::optional<FileId> file_at(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return FileId(status.st_dev, status.st_ino);
  }

  /// Only the owner may read the file, whatever the permissions of its folder are, because it holds other people's
  /// meshes. The mode is set by name: opening and closing the file here would release the locks that SQLite holds on
  /// it.
  static void close_to_others(const std::string& path) {
    for (const char* part : {"", "-wal", "-shm"}) ::chmod((path + part).c_str(), S_IRUSR | S_IWUSR);
  }

  void set_up(FileClock& clock) {
    check(::sqlite3_busy_handler(handle_, nap, this));
    check(::sqlite3_create_function(handle_, "remeshd_now", 0, SQLITE_UTF8 | SQLITE_INNOCUOUS, &clock, give_now,
                                    nullptr, nullptr));
    // This setting allows freed pages to be returned to the file system. It affects new files only, and on other files
    // it would wait for the present writer.
    if (run("PRAGMA page_count", {}, Result::kText).at(0).at(0) == "0") set_patiently("PRAGMA auto_vacuum=INCREMENTAL");
    // Debian's SQLite overwrites what is deleted with zeros, and writes all of them to the log first. So a deletion
    // would need as much room as it makes. With FAST, only pages that are written in any case are overwritten.
    for (const char* pragma : {"PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL", "PRAGMA secure_delete=FAST",
                               "PRAGMA journal_size_limit=8388608", "PRAGMA temp_store=MEMORY"}) {
      set_patiently(pragma);
    }
    set_patiently("SELECT count(*) FROM sqlite_master");  // this opens the log
  }

  /// If two connections set the journal mode of a new file at once, each may hold a lock that the other waits for.
  /// SQLite then tells one of them so immediately, without calling the busy handler.
  void set_patiently(const char* pragma) {
    for (int naps = 0;; ++naps) {
      try {
        run(pragma, {}, Result::kText);
        return;
      } catch (const StoreError&) {
        if (::sqlite3_errcode(handle_) != SQLITE_BUSY || nap(this, naps) == 0) throw;
      }
    }
  }

  /// Output: 0 if the time to wait is over.
  static int nap(void* database, int) {
    if (static_cast<const SqliteDatabase*>(database)->deadline().is_over()) return 0;
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
    const std::string reason = std::string(::sqlite3_errmsg(handle_)) + " (" + ::sqlite3_errstr(code) + ")";
    constexpr int kPrimary = 0xff;  // the rest of a code says more about it
    switch (code & kPrimary) {
      case SQLITE_FULL: throw StoreFull(reason);
      case SQLITE_TOOBIG:
      case SQLITE_CONSTRAINT:
      case SQLITE_MISMATCH: throw DataError(reason);
      default: break;
    }
    // The file that SQLite maps must have room before it is mapped.
    if (code == SQLITE_IOERR_SHMSIZE) throw StoreFull(reason);
    if (reason.find("no such table") != std::string::npos) throw SchemaMissing(reason);
    throw StoreError(reason);
  }

  const std::string path_;
  std::optional<FileId> file_;
  std::optional<FileId> log_;
  sqlite3* handle_ = nullptr;
};

class SqliteDriver : public DatabaseDriver {
 public:
  explicit SqliteDriver(std::string path)
      : path_(std::move(path)), reserve_(std::filesystem::path(path_).parent_path().string()) {}

  std::unique_ptr<Database> connect_by(const StoreDeadline& deadline) override { return open(deadline); }
  bool is_current(const Database& database) const override {
    return static_cast<const SqliteDatabase&>(database).is_current();
  }
  std::string_view skip_locked() const override { return ""; }
  bool keeps_fractions() const override { return true; }
  std::vector<std::string> schema_statements(std::int64_t version) const override {
    if (version != 1) return {};
    return {"CREATE TABLE remeshd_clock (boot text NOT NULL, base_ms bigint NOT NULL)"};
  }
  bool has_table(Database& database, std::string_view name) const override {
    return database.finds("SELECT name FROM sqlite_master WHERE type = 'table' AND name = $1", {name});
  }
  void lock_schema(Database&) const override {}  // BEGIN IMMEDIATE has locked it already
  void prepare(Database& database) override {
    reserve_.keep();  // before anything else fills the volume
    Transaction transaction(database);
    const std::string boot = boot_id();
    const Rows known = database.run("SELECT boot, base_ms FROM remeshd_clock");
    const auto base_of_boot = known.empty() ? std::nullopt : maybe_integer(known[0][1]);
    if (base_of_boot && known[0][0] == boot && !boot.empty()) {
      clock_.set_base(*base_of_boot);
      return;
    }
    const Rows last = database.run("SELECT touched_ms FROM remeshd_schema");
    const std::int64_t base = FileClock::new_base(maybe_integer(last.at(0).at(0)).value_or(0));
    database.run("DELETE FROM remeshd_clock");
    database.run("INSERT INTO remeshd_clock (boot, base_ms) VALUES ($1, $2)", {std::string_view(boot), base});
    transaction.commit();
    clock_.set_base(base);
  }

  void keep_clock(Database& database) override {
    const auto behind_others = [&] {
      // Another process may have changed the base. A damaged base is written again.
      const Rows kept = database.run("SELECT base_ms FROM remeshd_clock");
      if (const auto base = kept.empty() ? std::nullopt : maybe_integer(kept[0][0]))
        clock_.set_base(*base);
      else
        database.run("UPDATE remeshd_clock SET base_ms = $1", {clock_.base_ms()});
      const std::int64_t behind = clock_.behind_ms();
      return behind > kWrongClock.count() || behind < -kWrongClock.count() ? behind : 0;
    };
    if (behind_others() == 0) return;
    Transaction transaction(database);
    const std::int64_t behind = behind_others();
    if (behind == 0) return;  // another process has shifted all times just now
    const std::int64_t base = clock_.base_ms() + behind;
    database.run("UPDATE remeshd_clock SET base_ms = $1", {base});
    shift_times(database, behind, StoreRules().timeout);
    transaction.commit();
    clock_.set_base(base);
  }

  void check_room(Database& database, std::uint64_t bytes, RoomFor purpose) const override {
    // The bytes are written to the log first, and then to the file, where free pages are reused.
    const std::uint64_t pages = bytes + bytes / 8 + kSmallWrite;
    const auto free = static_cast<std::uint64_t>(integer(database.run("PRAGMA freelist_count").at(0)[0])) * kPage;
    reserve_.check_room(pages + (pages > free ? pages - free : 0), purpose);
  }
  bool cut_log(Database& database) const override {
    const std::uint64_t size = log_size();
    try {
      database.run("PRAGMA wal_checkpoint(TRUNCATE)");  // this reports no error if others are reading
    } catch (const StoreError&) {
      return false;  // the file itself has no room to grow, or another process holds it for long
    }
    return log_size() < size;
  }
  bool release_reserve() const override { return reserve_.release(); }

  void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                    std::string_view bytes, std::uint64_t size) override {
    database.run("INSERT INTO remeshd_blob (job, kind, part, data, size) VALUES ($1, $2, $3, $4, nullif($5, -1))",
                 {job, kind, part, Bytes{bytes}, part == 0 ? static_cast<std::int64_t>(size) : -1});
  }
  std::int64_t rows_of_blob(std::int64_t last) const override { return last / kPartsOfPiece + 1; }

  void after(Database& database) const override {
    // The log takes room besides the file. Writing back its pages to the file needs room as well, so the log must not
    // grow until there is no room.
    if (!reserve_.is_scarce()) return;
    if (log_size() > kShortLog) cut_log(database);
    reserve_.keep();  // what a deletion has taken out of it, or has made free
  }

  void tidy(Database& database) override {
    // Free pages are reused, and so is the log. The files shrink, a little at a time, only if these are large or other
    // files need the room.
    const bool is_scarce = reserve_.is_scarce();
    const auto cut_if_long = [&] {
      if (log_size() > (is_scarce ? 0 : kMaxLog)) cut_log(database);
    };
    cut_if_long();  // first, because all following statements write to the log
    try {
      for (int round = 0; round < kRounds; ++round) {
        const std::int64_t free_pages = integer(database.run("PRAGMA freelist_count").at(0)[0]);
        // Moving a page changes some other pages, and all of these are written to the log. On a full volume, the room
        // for that comes out of the reserve, which gets more back.
        if (is_scarce && free_pages > 0 && reserve_.free() < kRoomToMove) reserve_.release();
        const auto room = static_cast<std::int64_t>(reserve_.free() / kPage / 8);
        const std::int64_t pages = std::min(is_scarce ? free_pages : free_pages - kKeptPages, std::min(room, kMoved));
        if (pages <= 0) break;
        database.run(("PRAGMA incremental_vacuum(" + std::to_string(pages) + ")").c_str());
        cut_if_long();
        if (!is_scarce) break;
      }
    } catch (const StoreFull&) {
      // The pages stay in the file, where they are used again.
    }
    reserve_.keep();
  }

  void wait_for_work(const Event& wake, Clock::time_point until, const StoreDeadline& deadline) override {
    // Only one thread waits at a time, because the daemon has one thread that claims.
    if (watcher_ && !watcher_->is_current()) watcher_.reset();
    if (!watcher_) watcher_ = open(deadline);
    watcher_->set_deadline(deadline);
    do {
      if (wake.wait(std::min(until, Clock::now() + kLookForChanges))) return;
      if (!watcher_->is_current()) return watcher_.reset();
      watcher_->extend_deadline(kLookForChanges);
      const std::string version = watcher_->run("PRAGMA data_version", {}, Database::Result::kText).at(0).at(0).value();
      if (std::exchange(version_, version) != version) return;
    } while (Clock::now() < until);
  }

  std::size_t max_connections() const override { return 8; }

 private:
  std::uint64_t log_size() const {
    struct stat status {};
    return ::stat((path_ + "-wal").c_str(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
  }
  std::unique_ptr<SqliteDatabase> open(const StoreDeadline& deadline) {
    return std::make_unique<SqliteDatabase>(path_, clock_, deadline);
  }

  const std::string path_;
  const DiskReserve reserve_;
  FileClock clock_;
  std::unique_ptr<SqliteDatabase> watcher_;
  std::string version_;
};

}  // namespace

std::unique_ptr<DatabaseDriver> make_sqlite_driver(const std::string& path) {
  return std::make_unique<SqliteDriver>(path);
}

}  // namespace remesh::server::jobs
