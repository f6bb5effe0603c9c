/// Writes JSON text sequentially, without a document tree, so that an answer of millions of faces takes only the
/// memory of its bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace remesh::api {

/// Writes one document. The caller opens and closes objects and arrays; the writer adds the commas.
/// Holds: the text is valid UTF-8 whatever bytes the strings have. A number is the shortest text that reads back to
///        the same double, or null if it is not finite.
class JsonWriter {
 public:
  JsonWriter() = default;
  /// Input: `piece` - the text is kept in pieces of about so many bytes. Where memory is nearly full, a large text fits
  ///        between other things only in pieces.
  explicit JsonWriter(std::size_t piece) : piece_(piece) {}

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

  void value(bool of) { boolean(of); }
  void value(double of) { number(of); }
  void value(std::uint64_t of) { integer(of); }
  void value(std::string_view of) { string(of); }
  void value(const char* of) { string(of); }  // a pointer to characters would otherwise convert to bool
  /// Writes a value, or null if there is none.
  template <class T>
  void value(const std::optional<T>& of) {
    of ? value(*of) : null();
  }

  // These functions write a whole object or list. With a name, they write a key first.

  template <class T>
  void member(std::string_view name, const T& of) {
    key(name);
    value(of);
  }
  /// `write` writes the members of the object.
  template <class Write>
  void object(const Write& write) {
    begin_object();
    write();
    end_object();
  }
  template <class Write>
  void object(std::string_view name, const Write& write) {
    key(name);
    object(write);
  }
  /// `write` writes an item as one value.
  template <class Items, class Write>
  void list(const Items& items, const Write& write) {
    begin_array();
    for (const auto& item : items) write(item);
    end_array();
  }
  template <class Items, class Write>
  void list(std::string_view name, const Items& items, const Write& write) {
    key(name);
    list(items, write);
  }
  /// The items are the values.
  template <class Items>
  void values(std::string_view name, const Items& items) {
    list(name, items, [&](const auto& item) { value(item); });
  }
  /// `write` writes the members of an item's object.
  template <class Items, class Write>
  void objects(std::string_view name, const Items& items, const Write& write) {
    list(name, items, [&](const auto& item) { object([&] { write(item); }); });
  }

  /// Pieces need no more memory than their own.
  void reserve(std::size_t bytes) {
    if (piece_ == kWhole) out_.reserve(bytes);
  }
  std::size_t size() const { return in_pieces_ + out_.size(); }
  std::size_t capacity() const { return in_pieces_ + out_.capacity(); }
  /// Moves out the text, if it is not kept in pieces.
  std::string take() { return std::move(out_); }
  std::vector<std::string> take_pieces() {
    pieces_.push_back(std::move(out_));
    return std::move(pieces_);
  }

 private:
  void open(char bracket);
  void close(char bracket);
  void literal(std::string_view text);
  void separate();
  void quote(std::string_view text);

  static constexpr std::size_t kWhole = std::numeric_limits<std::size_t>::max();

  std::string out_;
  bool needs_comma_ = false;
  std::size_t piece_ = kWhole;
  std::vector<std::string> pieces_;  ///< before `out_`
  std::size_t in_pieces_ = 0;        ///< their bytes
};

}  // namespace remesh::api
