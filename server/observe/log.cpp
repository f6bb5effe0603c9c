#include "server/observe/log.h"

#include <pthread.h>
#include <spdlog/async.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <memory>

#include "server/observe/log_sink.h"
#include "server/observe/niceness.h"

namespace remesh::server::log {
namespace {

Format active_format = Format::kText;

/// Appends a JSON string. Bytes beyond ASCII are escaped as Latin-1, because text from clients need not be valid UTF-8.
void append_quoted(std::string& line, std::string_view text) {
  line += '"';
  for (const char c : text) {
    if (const auto byte = static_cast<unsigned char>(c); c == '"' || c == '\\') {
      line += '\\';
      line += c;
    } else if (byte < 0x20 || byte >= 0x7f) {
      fmt::format_to(std::back_inserter(line), "\\u{:04x}", byte);
    } else {
      line += c;
    }
  }
  line += '"';
}

bool is_plain(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 0x7f && c != '"'; });
}

void append_value(std::string& line, Format format, const Field& field) {
  if (const auto* number = std::get_if<std::int64_t>(&field.value)) {
    fmt::format_to(std::back_inserter(line), "{}", *number);
  } else if (const auto* number = std::get_if<double>(&field.value)) {
    fmt::format_to(std::back_inserter(line), "{:.3f}", *number);
  } else if (const std::string& text = std::get<std::string>(field.value); format == Format::kText && is_plain(text)) {
    line += text;
  } else {
    append_quoted(line, text);
  }
}

spdlog::level::level_enum spdlog_level(Level level) {
  switch (level) {
    case Level::kDebug: return spdlog::level::debug;
    case Level::kInfo: return spdlog::level::info;
    case Level::kWarning: return spdlog::level::warn;
    case Level::kError: return spdlog::level::err;
    case Level::kOff: return spdlog::level::off;
  }
  return spdlog::level::err;
}

/// The max number of lines that wait to be written. Beyond it the oldest lines are dropped, because a stalled log must
/// not stall requests.
constexpr std::size_t kMaxWaiting = 8192;

/// Lowers the priority of the thread that writes. On a busy machine the thread then writes several lines at its turn,
/// instead of interrupting a request for each line.
void let_others_first() {
  const sched_param none{};
  (void)::pthread_setschedparam(::pthread_self(), SCHED_BATCH, &none);
  be_nice();
}

/// How long the process, at its end, waits for lines that have not been written yet.
constexpr std::chrono::milliseconds kLastLines{500};
/// How often the log reports that lines were dropped.
constexpr std::chrono::seconds kBetweenLosses{10};

/// The logger and the thread that writes for it.
struct Writing {
  Writing()
      : sink(std::make_shared<LogSink>(STDERR_FILENO)),
        thread(std::make_shared<spdlog::details::thread_pool>(kMaxWaiting, 1, let_others_first)),
        logger(std::make_shared<spdlog::async_logger>("remeshd", sink, thread,
                                                      spdlog::async_overflow_policy::overrun_oldest)) {}
  /// Ends the thread before the logger, which its lines refer to.
  ~Writing() {
    sink->end_at(std::chrono::steady_clock::now() + kLastLines);
    thread.reset();
  }

  std::shared_ptr<LogSink> sink;
  std::shared_ptr<spdlog::details::thread_pool> thread;
  std::shared_ptr<spdlog::async_logger> logger;
};

Writing& writing() {
  static Writing writing;
  return writing;
}

spdlog::logger& logger() { return *writing().logger; }

/// Reports how many lines were dropped since the last report.
void report_losses() {
  static std::atomic<std::uint64_t> told{0};
  static std::atomic<std::chrono::steady_clock::time_point> next{};
  const std::uint64_t lost = dropped_lines();
  if (lost == told) return;
  const auto now = std::chrono::steady_clock::now();
  if (auto due = next.load(); now < due || !next.compare_exchange_strong(due, now + kBetweenLosses)) return;
  const std::uint64_t before = told.exchange(lost);
  if (lost <= before) return;
  const std::vector<Field> fields{{"lines", static_cast<std::int64_t>(lost - before)}};
  logger().log(
      spdlog::level::warn,
      render(active_format, "log lines were dropped, because standard error accepted them too slowly", fields));
}

}  // namespace

std::uint64_t dropped_lines() { return writing().sink->dropped() + writing().thread->overrun_counter(); }

void set_up(Format format, Level level) {
  active_format = format;
  if (format == Format::kAuto) active_format = ::isatty(STDERR_FILENO) != 0 ? Format::kText : Format::kJson;
  const bool is_json = active_format == Format::kJson;
  const char* pattern = is_json ? R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v})" : "%H:%M:%S.%e %l %v";
  logger().set_formatter(std::make_unique<spdlog::pattern_formatter>(
      pattern, is_json ? spdlog::pattern_time_type::utc : spdlog::pattern_time_type::local));
  logger().set_level(spdlog_level(level));
}

std::string render(Format format, std::string_view event, const std::vector<Field>& fields) {
  constexpr std::size_t kUsualField = 32;
  const bool is_json = format == Format::kJson;
  std::string line;
  line.reserve(kUsualField * (fields.size() + 1));
  if (is_json) {
    line += "\"event\":";
    append_quoted(line, event);
  } else {
    line += event;
  }
  for (const Field& field : fields) {
    if (is_json) {
      line += ',';
      append_quoted(line, field.name);
      line += ':';
    } else {
      line.append(" ").append(field.name) += '=';
    }
    append_value(line, format, field);
  }
  return line;
}

bool is_written(Level level) { return logger().should_log(spdlog_level(level)); }

void write(Level level, std::string_view event, const std::vector<Field>& fields) {
  if (!is_written(level)) return;
  report_losses();
  logger().log(spdlog_level(level), render(active_format, event, fields));
}

}  // namespace remesh::server::log
