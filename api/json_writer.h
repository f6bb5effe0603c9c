/// Writes JSON text sequentially, without a document tree, so that an answer of millions of faces takes only the
/// memory of its bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace remesh::api {

/// Writes one document. The caller opens and closes objects and arrays; the writer adds the commas.
/// Holds: the text is valid UTF-8 whatever bytes the strings have. A number is the shortest text that reads back to
///        the same double, or null if it is not finite.
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
  /// Writes a value that is JSON already.
  void raw(std::string_view json) { literal(json); }

  /// These functions write a key with its value, or with null if there is none.
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
  /// This overload exists because a pointer to characters would otherwise convert to bool.
  void member(std::string_view name, const char* value) { member(name, std::string_view(value)); }
  template <class T>
  void member(std::string_view name, const std::optional<T>& value) {
    if (value) return member(name, *value);
    key(name);
    null();
  }

  void reserve(std::size_t bytes) { out_.reserve(bytes); }
  std::size_t size() const { return out_.size(); }
  std::size_t capacity() const { return out_.capacity(); }
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
