#include <libpq-fe.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "server/jobs/database.h"

namespace remesh::server::jobs {
namespace {

/// How long to wait for an answer. It is longer than any statement may take.
constexpr std::chrono::seconds kPatience{20};
constexpr const char* kChannel = "remeshd_jobs";
/// Takes the advisory lock under which the schema is created. The number is arbitrary, but nobody else may use it.
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

Connected open_connection(const std::string& url) {
  // Settings in the URL take precedence: later values win, and the URL is expanded at its position, which is last.
  const std::array<const char*, 9> names{"application_name",    "connect_timeout",  "keepalives_idle",
                                         "keepalives_interval", "keepalives_count", "tcp_user_timeout",
                                         "client_encoding",     "dbname",           nullptr};
  const std::array<const char*, 9> values{"remeshd", "5", "10", "5", "3", "15000", "UTF8", url.c_str(), nullptr};
  Connected connection(::PQconnectdbParams(names.data(), values.data(), /*expand_dbname=*/1), ::PQfinish);
  if (::PQstatus(connection.get()) != CONNECTION_OK)
    throw ConnectionBroken(one_line(::PQerrorMessage(connection.get())));
  return connection;
}

class PostgresDatabase final : public Database {
 public:
  explicit PostgresDatabase(const std::string& url) : connection_(open_connection(url)) {
    ::PQsetnonblocking(connection_.get(), 1);  // sending continues while waiting for the answer
    ::PQsetNoticeProcessor(
        connection_.get(), [](void*, const char*) {}, nullptr);
    run("SET statement_timeout = '15s'", {}, Result::kText);
    run("SET lock_timeout = '10s'", {}, Result::kText);
    run("SET idle_in_transaction_session_timeout = '60s'", {}, Result::kText);
    // An accepted job must be on the disk, whatever the server's setting is. Stronger settings are not changed.
    run("SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'", {},
        Result::kText);
  }

  Rows run(const char* sql, const Values& parameters, Result result) override {
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

  void begin() override { run("BEGIN", {}, Result::kText); }
  void commit() override {
    if (::PQsendQuery(connection_.get(), "COMMIT") != 1)
      throw ConnectionBroken(one_line(::PQerrorMessage(connection_.get())));
    const Answered answer = wait_for_answer();
    // If the connection is lost here, nobody can tell whether the commit happened, so it must not be repeated
    // blindly.
    if (::PQresultStatus(answer.get()) != PGRES_COMMAND_OK)
      throw StoreError("commit: " + one_line(::PQerrorMessage(connection_.get())));
    // COMMIT acts as ROLLBACK for a transaction that had failed.
    if (std::string_view(::PQcmdStatus(answer.get())) != "COMMIT") throw StoreError("the transaction was rolled back");
  }
  void roll_back() noexcept override {
    if (!is_stuck_ && ::PQstatus(connection_.get()) == CONNECTION_OK)
      ::PQclear(::PQexec(connection_.get(), "ROLLBACK"));
  }
  void announce() override { run("SELECT pg_notify($1, '')", {std::string_view(kChannel)}, Result::kText); }

 private:
  /// Waits like libpq does, but with a deadline: a server that does not answer counts as one that went away.
  /// Errors: StoreError - nobody can tell what became of the statement.
  Answered wait_for_answer() {
    const Clock::time_point deadline = Clock::now() + kPatience;
    while (::PQisBusy(connection_.get()) == 1) {
      pollfd entry{::PQsocket(connection_.get()), POLLIN, 0};
      // Bytes that are not sent yet must go out too, so it also waits until the socket is writable.
      if (::PQflush(connection_.get()) == 1) entry.events |= POLLOUT;
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (left <= 0) {
        is_stuck_ = true;
        throw StoreError("the server does not answer");
      }
      ::poll(&entry, 1, static_cast<int>(left));
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
    const char* const state = ::PQresultErrorField(answer, PG_DIAG_SQLSTATE);
    const bool is_over = ::PQstatus(connection_.get()) != CONNECTION_OK;
    // Class 57P means that an administrator ends the server or this connection.
    if (is_over || (state != nullptr && std::string_view(state).substr(0, 3) == "57P")) throw ConnectionBroken(reason);
    throw StoreError(reason);
  }

  const Connected connection_;
  bool is_stuck_ = false;
};

class PostgresDriver : public DatabaseDriver {
 public:
  explicit PostgresDriver(std::string url) : url_(std::move(url)) {
    char* reason = nullptr;
    PQconninfoOption* const options = ::PQconninfoParse(url_.c_str(), &reason);
    if (options == nullptr) {
      const std::string text = one_line(reason);
      ::PQfreemem(reason);
      throw std::invalid_argument(text);
    }
    ::PQconninfoFree(options);
  }

  std::unique_ptr<Database> connect() override { return std::make_unique<PostgresDatabase>(url_); }
  std::string_view skip_locked() const override { return " FOR UPDATE SKIP LOCKED"; }

  std::vector<std::string> schema_statements() const override {
    return {// It gives the start of the statement, so that all rows of one statement see the same time.
            "CREATE FUNCTION remeshd_now() RETURNS bigint LANGUAGE sql STABLE AS "
            "$$ SELECT (extract(epoch FROM statement_timestamp()) * 1000)::bigint $$",
            // Rows that just fit into a page are neither compressed nor moved out of line. This halves the work for
            // large blobs.
            "ALTER TABLE remeshd_blob ALTER COLUMN data SET STORAGE PLAIN",
            // The table of jobs is small and its rows change often, so it is vacuumed often.
            "ALTER TABLE remeshd_job SET (fillfactor = 70, autovacuum_vacuum_scale_factor = 0.02, "
            "autovacuum_vacuum_threshold = 500, autovacuum_analyze_scale_factor = 0.05)"};
  }
  void lock_schema(Database& database) const override { database.run(kSchemaLock); }
  void prepare(Database&) override {}
  void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                    std::string_view bytes) override {
    constexpr std::int64_t kRow = kPiece / kPartsOfPiece;
    const std::int64_t last = std::max<std::int64_t>(0, (static_cast<std::int64_t>(bytes.size()) - 1) / kRow);
    database.run(
        "INSERT INTO remeshd_blob (job, kind, part, data) SELECT $1, $2, $3::int + i, "
        "substring($4::bytea FROM i * $5::int + 1 FOR $5::int) FROM generate_series(0, $6::int) AS i",
        {job, kind, part, Bytes{bytes}, kRow, last});
  }
  void tidy(Database&) override {}  // PostgreSQL does that by itself

  void wait_for_work(const Event& wake, Clock::time_point until) override {
    if (!listener_ || ::PQstatus(listener_.get()) != CONNECTION_OK) {
      listener_ = open_connection(url_);
      const Answered answer(::PQexec(listener_.get(), (std::string("LISTEN ") + kChannel).c_str()), ::PQclear);
      if (::PQresultStatus(answer.get()) != PGRES_COMMAND_OK) {
        throw ConnectionBroken(one_line(::PQerrorMessage(listener_.get())));
      }
      return;  // nobody heard earlier announcements, so the caller must look at once
    }
    std::array<pollfd, 2> entries{pollfd{wake.fd(), POLLIN, 0}, pollfd{::PQsocket(listener_.get()), POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    ::poll(entries.data(), entries.size(), static_cast<int>(std::max<std::int64_t>(left, 0)));
    if (entries[1].revents == 0) return;
    if (::PQconsumeInput(listener_.get()) == 0) {
      const std::string reason = one_line(::PQerrorMessage(listener_.get()));
      listener_.reset();
      throw ConnectionBroken(reason);
    }
    while (PGnotify* const heard = ::PQnotifies(listener_.get())) ::PQfreemem(heard);
  }

  std::size_t max_connections() const override { return 8; }

 private:
  const std::string url_;
  Connected listener_{nullptr, ::PQfinish};
};

}  // namespace

std::unique_ptr<DatabaseDriver> make_postgres_driver(const std::string& url) {
  return std::make_unique<PostgresDriver>(url);
}

}  // namespace remesh::server::jobs
