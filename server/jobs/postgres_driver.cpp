#include <libpq-fe.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "server/jobs/database.h"
#include "server/jobs/row_values.h"
#include "server/jobs/store_clock.h"

namespace remesh::server::jobs {
namespace {

/// The interval in which a waiting call checks whether the daemon is stopping.
constexpr std::chrono::milliseconds kLookAtSocket{50};
/// If no daemon keeps the store's clock, it advances by at most this much.
constexpr std::chrono::milliseconds kMaxStep{15'000};
/// If no daemon has kept the clock for this long, no daemon was running.
constexpr std::chrono::minutes kUnkept{1};
/// The server's clock now, in milliseconds.
constexpr const char* kWall = "(extract(epoch FROM clock_timestamp()) * 1000)::bigint";
constexpr const char* kChannel = "remeshd_jobs";
/// Takes the advisory lock under which the schema is created. The number is arbitrary, but no other program may use it.
constexpr const char* kSchemaLock = "SELECT pg_advisory_xact_lock(7270150413)";

using Connected = std::unique_ptr<PGconn, void (*)(PGconn*)>;
using Answered = std::unique_ptr<PGresult, void (*)(PGresult*)>;

std::string one_line(const char* message) {
  std::string text = message == nullptr ? "" : message;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

/// One of the hosts that a connection string names.
struct Host {
  std::string name, address, port;
};

std::vector<std::string> list_entries(const char* list) {
  std::vector<std::string> entries;
  std::istringstream text(list == nullptr ? "" : list);
  for (std::string entry; std::getline(text, entry, ',');) entries.push_back(entry);
  return entries;
}

/// Output: empty if the string names at most one host.
/// Errors: std::invalid_argument - libpq cannot parse the string.
std::vector<Host> hosts_of(const std::string& url) {
  char* reason = nullptr;
  const std::unique_ptr<PQconninfoOption, void (*)(PQconninfoOption*)> options(::PQconninfoParse(url.c_str(), &reason),
                                                                               ::PQconninfoFree);
  if (!options) {
    const std::string text = one_line(reason);
    ::PQfreemem(reason);
    throw std::invalid_argument(text);
  }
  std::vector<std::string> names, addresses, ports;
  for (const PQconninfoOption* option = options.get(); option->keyword != nullptr; ++option) {
    const std::string_view keyword = option->keyword;
    if (keyword == "host") names = list_entries(option->val);
    if (keyword == "hostaddr") addresses = list_entries(option->val);
    if (keyword == "port") ports = list_entries(option->val);
  }
  std::vector<Host> hosts(std::max(names.size(), addresses.size()));
  if (hosts.size() < 2) return {};
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    if (i < names.size()) hosts[i].name = names[i];
    if (i < addresses.size()) hosts[i].address = addresses[i];
    if (!ports.empty()) hosts[i].port = ports[std::min(i, ports.size() - 1)];
  }
  return hosts;
}

/// Reads the password from its file, anew for each connection, so that a changed password needs no restart.
/// Output: empty if there is no file; then the password is that of the URL.
/// Errors: StoreError - the file cannot be read.
std::string read_password(const std::string& path) {
  std::string password;
  if (path.empty()) return password;
  std::ifstream file(path);
  if (!std::getline(file, password) && !file.eof()) throw StoreError("cannot read the file of the password, " + path);
  if (password.ends_with('\r')) password.pop_back();
  return password;
}

/// The address of the server, and the data for logging in.
struct Login {
  std::string url;
  std::string password_file;  ///< may be empty
};

/// Connects without blocking, because libpq's own time limit counts whole seconds and restarts for each host.
Connected begin_connection(const Login& login, const Host& host, const StoreDeadline& deadline) {
  // Later values win, and the URL is expanded at its position. So settings in the URL take precedence over those before
  // it, and the host over the URL's list of hosts. Empty values count as absent.
  const std::array<const char*, 12> names{"application_name",
                                          "keepalives_idle",
                                          "keepalives_interval",
                                          "keepalives_count",
                                          "tcp_user_timeout",
                                          "client_encoding",
                                          "dbname",
                                          "password",
                                          "host",
                                          "hostaddr",
                                          "port",
                                          nullptr};
  const std::string password = read_password(login.password_file);
  const bool is_one_of_many = !host.name.empty() || !host.address.empty();
  const auto chosen = [&](const std::string& value) { return is_one_of_many ? value.c_str() : nullptr; };
  const std::array<const char*, 12> values{"remeshd",
                                           "10",
                                           "5",
                                           "3",
                                           "15000",
                                           "UTF8",
                                           login.url.c_str(),
                                           password.c_str(),
                                           chosen(host.name),
                                           chosen(host.address),
                                           chosen(host.port),
                                           nullptr};
  Connected connection(::PQconnectStartParams(names.data(), values.data(), /*expand_dbname=*/1), ::PQfinish);
  if (!connection) throw std::bad_alloc();
  PostgresPollingStatusType step = PGRES_POLLING_WRITING;
  while (step != PGRES_POLLING_OK) {
    if (step == PGRES_POLLING_FAILED || ::PQstatus(connection.get()) == CONNECTION_BAD)
      throw ConnectionBroken(one_line(::PQerrorMessage(connection.get())));
    if (deadline.is_over()) throw StoreError("the server does not answer");
    const short events = step == PGRES_POLLING_READING ? POLLIN : POLLOUT;
    pollfd entry{::PQsocket(connection.get()), events, 0};
    if (::poll(&entry, 1, static_cast<int>(deadline.left(kLookAtSocket).count())) > 0)
      step = ::PQconnectPoll(connection.get());
  }
  return connection;
}

Connected open_connection(const Login& login, const StoreDeadline& deadline) {
  const std::vector<Host> hosts = hosts_of(login.url);
  if (hosts.empty()) return begin_connection(login, Host{}, deadline);
  // Each host gets only a part of the time, so that a host that does not answer leaves time for the other hosts.
  for (std::size_t i = 0;; ++i) {
    try {
      const auto left = deadline.left(std::chrono::minutes(1)) / static_cast<int>(hosts.size() - i);
      return begin_connection(login, hosts[i], deadline.sooner(Clock::now() + left));
    } catch (const StoreError&) {
      if (i + 1 == hosts.size()) throw;
    }
  }
}

class PostgresDatabase final : public Database {
 public:
  PostgresDatabase(const Login& login, std::chrono::milliseconds timeout, const StoreDeadline& deadline)
      : Database(deadline), connection_(open_connection(login, deadline)) {
    ::PQsetnonblocking(connection_.get(), 1);  // sending continues while waiting for the answer
    ::PQsetNoticeProcessor(
        connection_.get(), [](void*, const char*) {}, nullptr);
    check_encoding();
    // The role or the database may have other defaults. The server ends a wait for a lock before it ends the statement,
    // so that the error names the lock.
    const std::string milliseconds = std::to_string(timeout.count());
    const std::string for_locks = std::to_string(std::max<std::int64_t>(1, timeout.count() * 4 / 5));
    for (const std::string& setting :
         {"SET statement_timeout = " + milliseconds, "SET lock_timeout = " + for_locks,
          std::string("SET idle_in_transaction_session_timeout = '60s'"),
          std::string("SET default_transaction_isolation = 'read committed'"),
          std::string("SET default_transaction_deferrable = off"), std::string("SET row_security = on")}) {
      run(setting.c_str(), {}, Result::kText);
    }
    // An accepted job must be on the disk, whatever the server's setting is. Stricter settings are not changed.
    run("SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'", {},
        Result::kText);
  }

  Rows run(const char* sql, const Values& parameters, Result result) override {
    if (is_stuck_) throw ConnectionBroken("the connection is not usable any more");
    std::vector<std::string> texts;
    texts.reserve(parameters.size());  // so that pointers into it stay valid
    std::vector<const char*> values;
    std::vector<int> lengths, formats;
    for (const Value& value : parameters) {
      if (const auto* bytes = std::get_if<Bytes>(&value)) {
        values.push_back(bytes->bytes.empty() ? "" : bytes->bytes.data());
        lengths.push_back(static_cast<int>(bytes->bytes.size()));
        formats.push_back(1);
        continue;
      }
      texts.push_back(text_of(value));
      values.push_back(texts.back().c_str());
      lengths.push_back(0);
      formats.push_back(0);
    }
    if (::PQsendQueryParams(connection_.get(), sql, static_cast<int>(values.size()), nullptr, values.data(),
                            lengths.data(), formats.data(), result == Result::kBytes ? 1 : 0) != 1) {
      throw ConnectionBroken(one_line(::PQerrorMessage(connection_.get())));
    }
    const Answered answer = wait_for_answer();
    const ExecStatusType status = ::PQresultStatus(answer.get());
    if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) fail(answer.get());
    return rows_of(answer.get());
  }

  void begin() override { run("BEGIN ISOLATION LEVEL READ COMMITTED", {}, Result::kText); }
  void commit() override {
    if (::PQsendQuery(connection_.get(), "COMMIT") != 1)
      throw ConnectionBroken(one_line(::PQerrorMessage(connection_.get())));
    const Answered answer = wait_for_answer();
    // If the connection is lost at this point, it is unknown whether the commit happened, so it must not be repeated
    // blindly.
    if (::PQresultStatus(answer.get()) != PGRES_COMMAND_OK)
      throw StoreError("commit: " + one_line(::PQerrorMessage(connection_.get())));
    // COMMIT acts as ROLLBACK for a transaction that had failed.
    if (std::string_view(::PQcmdStatus(answer.get())) != "COMMIT") throw StoreError("the transaction was rolled back");
  }
  void roll_back() noexcept override {
    if (is_stuck_ || ::PQstatus(connection_.get()) != CONNECTION_OK) return;
    try {
      run("ROLLBACK", {}, Result::kText);
    } catch (const std::exception&) {
      is_stuck_ = true;  // the next statement finds the connection unusable
    }
  }
  void announce() override { run("SELECT pg_notify($1, '')", {std::string_view(kChannel)}, Result::kText); }

  bool is_usable() const override { return !is_stuck_ && ::PQstatus(connection_.get()) == CONNECTION_OK; }
  PGconn* handle() const { return connection_.get(); }

 private:
  /// A database in another encoding cannot store all names and problems. One without an encoding stores all bytes.
  void check_encoding() const {
    const char* const encoding = ::PQparameterStatus(connection_.get(), "server_encoding");
    const std::string_view name = encoding == nullptr ? "" : encoding;
    if (name == "UTF8" || name == "SQL_ASCII") return;
    throw StoreUnusable("the database has the encoding " + std::string(name) +
                        ", which cannot store all text: create it with the encoding UTF8");
  }

  /// Waits for the answer like libpq does, but with a deadline: a server that does not answer in time counts as gone.
  /// Errors: StoreError - it is unknown whether the statement took effect.
  Answered wait_for_answer() {
    while (::PQisBusy(connection_.get()) == 1) {
      pollfd entry{::PQsocket(connection_.get()), POLLIN, 0};
      // Bytes that are not sent yet must be sent too, so the function also waits until the socket is writable.
      if (::PQflush(connection_.get()) == 1) entry.events |= POLLOUT;
      if (deadline().is_over()) {
        is_stuck_ = true;
        throw StoreError("the server does not answer");
      }
      ::poll(&entry, 1, static_cast<int>(deadline().left(kLookAtSocket).count()));
      if (entry.revents != 0 && ::PQconsumeInput(connection_.get()) != 1) break;
    }
    Answered answer(::PQgetResult(connection_.get()), ::PQclear);
    while (PGresult* const more = ::PQgetResult(connection_.get())) ::PQclear(more);
    return answer;
  }

  static std::string text_of(const Value& value) {
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
    if (const auto* real = std::get_if<double>(&value)) return std::to_string(*real);
    return std::string(std::get<std::string_view>(value));
  }

  static Rows rows_of(const PGresult* answer) {
    Rows rows(static_cast<std::size_t>(::PQntuples(answer)));
    for (int r = 0; r < ::PQntuples(answer); ++r) {
      for (int c = 0; c < ::PQnfields(answer); ++c) {
        if (::PQgetisnull(answer, r, c) != 0) {
          rows[static_cast<std::size_t>(r)].emplace_back();
        } else {
          rows[static_cast<std::size_t>(r)].emplace_back(std::in_place, ::PQgetvalue(answer, r, c),
                                                         static_cast<std::size_t>(::PQgetlength(answer, r, c)));
        }
      }
    }
    return rows;
  }

  [[noreturn]] void fail(const PGresult* answer) const {
    const std::string reason = one_line(::PQerrorMessage(connection_.get()));
    const char* const field = ::PQresultErrorField(answer, PG_DIAG_SQLSTATE);
    const std::string_view state = field == nullptr ? "" : field;
    const std::string_view state_class = state.substr(0, 2);
    // Class 57P means that an administrator ends the server or this connection.
    if (::PQstatus(connection_.get()) != CONNECTION_OK || state.substr(0, 3) == "57P") throw ConnectionBroken(reason);
    // An unknown table, function or schema.
    if (state == "42P01" || state == "42883" || state == "3F000") throw SchemaMissing(reason);
    if (state == "53100") throw StoreFull(reason);
    // Values that are not valid, that break a rule of the table, or that are too long.
    if (state_class == "22" || state_class == "23" || state_class == "54") throw DataError(reason);
    throw StoreError(reason);
  }

  const Connected connection_;
  bool is_stuck_ = false;
};

class PostgresDriver : public DatabaseDriver {
 public:
  PostgresDriver(Login login, std::chrono::milliseconds timeout) : login_(std::move(login)), timeout_(timeout) {
    hosts_of(login_.url);
  }

  std::unique_ptr<Database> connect_by(const StoreDeadline& deadline) override {
    return std::make_unique<PostgresDatabase>(login_, timeout_, deadline);
  }
  std::string_view skip_locked() const override { return " FOR UPDATE SKIP LOCKED"; }
  bool keeps_fractions() const override { return false; }

  std::vector<std::string> schema_statements(std::int64_t version) const override {
    if (version == 1) {
      return {// It gives the start of the statement, so that all rows of one statement see the same time.
              "CREATE OR REPLACE FUNCTION remeshd_now() RETURNS bigint LANGUAGE sql STABLE AS "
              "$$ SELECT (extract(epoch FROM statement_timestamp()) * 1000)::bigint $$",
              // Rows that just fit into a page are neither compressed nor moved out of line. This halves the work for
              // large blobs.
              "ALTER TABLE remeshd_blob ALTER COLUMN data SET STORAGE PLAIN",
              // The table of jobs is small and its rows change often, so it is vacuumed often.
              "ALTER TABLE remeshd_job SET (fillfactor = 70, autovacuum_vacuum_scale_factor = 0.02, "
              "autovacuum_vacuum_threshold = 500, autovacuum_analyze_scale_factor = 0.05)"};
    }
    // The store's clock advances from the stored time. It follows the server's clock only as far as it can have
    // advanced since then: daemons store the time every few seconds. So setting the server's clock has no effect.
    const std::string since = "greatest(0, least(wall - wall_ms, " + std::to_string(kMaxStep.count()) + "))";
    return {"CREATE TABLE remeshd_clock (store_ms bigint NOT NULL, wall_ms bigint NOT NULL)",
            "INSERT INTO remeshd_clock SELECT wall, wall FROM (SELECT " + std::string(kWall) + " AS wall) AS now",
            "CREATE OR REPLACE FUNCTION remeshd_now() RETURNS bigint LANGUAGE sql STABLE AS "
            "$$ SELECT store_ms + " +
                since +
                " FROM remeshd_clock, "
                "(SELECT (extract(epoch FROM statement_timestamp()) * 1000)::bigint AS wall) AS now $$"};
  }
  bool has_table(Database& database, std::string_view name) const override {
    return database.run("SELECT to_regclass($1)", {name}).at(0)[0].has_value();
  }
  void lock_schema(Database& database) const override {
    database.run(kSchemaLock);
    // A wait for a lock still ends, because other transactions wait behind it.
    database.run("SET LOCAL statement_timeout = 0");
  }
  /// Sets the store's clock after a time in which no daemon has kept it.
  void prepare(Database& database) override {
    database.run(("UPDATE remeshd_clock SET store_ms = greatest(store_ms, wall), wall_ms = wall FROM (SELECT " +
                  std::string(kWall) + " AS wall) AS now WHERE wall - wall_ms > $1 AND wall - store_ms < $2")
                     .c_str(),
                 {std::int64_t{std::chrono::milliseconds(kUnkept).count()}, std::int64_t{kWrongClock.count()}});
  }
  void keep_clock(Database& database) override {
    Transaction transaction(database);
    // The store's clock runs a tenth faster or slower until it agrees with the server's clock.
    const std::string since = "greatest(0, least(wall - wall_ms, " + std::to_string(kMaxStep.count()) + "))";
    const Rows rows =
        database.run(("UPDATE remeshd_clock SET wall_ms = wall, store_ms = store_ms + " + since + " + greatest(-" +
                      since + " / 10, least(" + since + " / 10, wall - store_ms - " + since + ")) FROM (SELECT " +
                      std::string(kWall) + " AS wall) AS now RETURNING wall_ms - store_ms")
                         .c_str());
    const std::int64_t behind = rows.empty() ? 0 : integer(rows[0][0]);
    if (behind > kWrongClock.count() || behind < -kWrongClock.count()) {
      // No other transaction may write a time of the old clock during the following statements.
      database.run("LOCK TABLE remeshd_job, remeshd_idempotency IN SHARE ROW EXCLUSIVE MODE");
      database.run("UPDATE remeshd_clock SET store_ms = store_ms + $1", {behind});
      shift_times(database, behind, timeout_);
    }
    transaction.commit();
  }
  void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                    std::string_view bytes, std::uint64_t size) override {
    constexpr std::int64_t kRow = kPiece / kPartsOfPiece;
    const std::int64_t last = std::max<std::int64_t>(0, (static_cast<std::int64_t>(bytes.size()) - 1) / kRow);
    database.run(
        "INSERT INTO remeshd_blob (job, kind, part, data, size) SELECT $1, $2, $3::int + i, "
        "substring($4::bytea FROM i * $5::int + 1 FOR $5::int), CASE WHEN $3::int + i = 0 THEN $7::bigint END "
        "FROM generate_series(0, $6::int) AS i",
        {job, kind, part, Bytes{bytes}, kRow, last, static_cast<std::int64_t>(size)});
  }
  std::int64_t rows_of_blob(std::int64_t last) const override { return last + 1; }
  void tidy(Database&) override {}  // PostgreSQL returns unused space by itself

  void wait_for_work(const Event& wake, Clock::time_point until, const StoreDeadline& deadline) override {
    if (!listener_ || ::PQstatus(listener_->handle()) != CONNECTION_OK) {
      listener_ = std::make_unique<PostgresDatabase>(login_, timeout_, deadline);
      try {
        listener_->run((std::string("LISTEN ") + kChannel).c_str(), {}, Database::Result::kText);
      } catch (const StoreError&) {
        listener_.reset();
        throw;
      }
      return;  // earlier announcements were missed, so the caller must check at once
    }
    PGconn* const connection = listener_->handle();
    std::array<pollfd, 2> entries{pollfd{wake.fd(), POLLIN, 0}, pollfd{::PQsocket(connection), POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    ::poll(entries.data(), entries.size(), static_cast<int>(std::max<std::int64_t>(left, 0)));
    if (entries[1].revents == 0) return;
    if (::PQconsumeInput(connection) == 0) {
      const std::string reason = one_line(::PQerrorMessage(connection));
      listener_.reset();
      throw ConnectionBroken(reason);
    }
    while (PGnotify* const heard = ::PQnotifies(connection)) ::PQfreemem(heard);
  }

  std::size_t max_connections() const override { return 8; }

 private:
  const Login login_;
  const std::chrono::milliseconds timeout_;
  std::unique_ptr<PostgresDatabase> listener_;
};

}  // namespace

std::unique_ptr<DatabaseDriver> make_postgres_driver(const std::string& url, std::chrono::milliseconds timeout,
                                                     const std::string& password_file) {
  return std::make_unique<PostgresDriver>(Login{url, password_file}, timeout);
}

}  // namespace remesh::server::jobs
