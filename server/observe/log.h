/// The daemon's log: events with named values on standard error. Each event is one line, either text for people or a
/// JSON object for machines.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace remesh::server::log {

enum class Level { kDebug, kInfo, kWarning, kError, kOff };
enum class Format { kAuto, kText, kJson };  ///< kAuto: text if standard error is a terminal, else JSON

struct Field {
  std::string_view name;
  std::variant<std::string, std::int64_t, double> value;
};

/// Sets up the log. Until then it writes text from level info on.
void set_up(Format format, Level level);

/// The number of lines that were dropped since the start, because standard error took them too slowly.
std::uint64_t dropped_lines();

/// True if an event of this level is written.
bool is_written(Level level);

/// Writes one line. Values may come from clients: all characters that could break the line are escaped.
void write(Level level, std::string_view event, const std::vector<Field>& fields = {});

/// Formats a line as `write` does, without the time and the level.
std::string render(Format format, std::string_view event, const std::vector<Field>& fields);

}  // namespace remesh::server::log
