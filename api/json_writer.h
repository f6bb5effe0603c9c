/// JSON text, written as it goes along: no document tree, so that answers of millions of faces cost only their bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace remesh::api {

/// Writes one document. The caller opens and closes what it should; commas come by themselves.
/// Holds: the text is valid UTF-8, whatever bytes the strings have; numbers are the shortest text that reads back to
///        the same double, and null where they are not finite.
class JsonWriter {
 public:
  void begin_object() { open('{'); }
  void end_object() { close('}'); }
  void begin_array() { open('['); }
  void end_array() { close(']'); }
  void key(std::string_view name);

  void null() { literal("null"); }
  void boolean(bool value) { literal(value ? "true" : "false"); }
  void number(double value);
  void integer(std::uint64_t value);
  void signed_integer(std::int64_t value);
  void string(std::string_view value);
  /// A value that is JSON already.
  void raw(std::string_view json) { literal(json); }

  /// A key with its value; null where there is none.
  void member(std::string_view name, bool value) {
    key(name);
    boolean(value);
  }
  void member(std::string_view name, double value) {
    key(name);
    number(value);
  }
  void member(std::string_view name, std::uint64_t value) {
    key(name);
    integer(value);
  }
  void member(std::string_view name, std::string_view value) {
    key(name);
    string(value);
  }
  /// Else a pointer to characters would be taken for a bool.
  void member(std::string_view name, const char* value) { member(name, std::string_view(value)); }
  template <class T>
  void member(std::string_view name, const std::optional<T>& value) {
    if (value) return member(name, *value);
    key(name);
    null();
  }

  void reserve(std::size_t bytes) { out_.reserve(bytes); }
  std::string take() { return std::move(out_); }

 private:
  void open(char bracket);
  void close(char bracket);
  void literal(std::string_view text);
  void separate();
  void quote(std::string_view text);

  std::string out_;
  bool needs_comma_ = false;
};

}  // namespace remesh::api
