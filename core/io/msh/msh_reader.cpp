#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/io/common/bytes.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/common/node_tags.h"
#include "core/io/common/numbered_labels.h"
#include "core/io/common/text_tokens.h"
#include "core/io/msh/msh.h"

namespace remesh {
namespace {

/// An element type: its number of nodes, and if it is a triangle or a quadrilateral, its number of corners.
struct ElementType {
  std::uint8_t nodes = 0;  ///< 0: there is no type of this number
  std::uint8_t corners = 0;
};
/// By Gmsh's number.
constexpr std::array<ElementType, 94> kElementTypes = [] {
  std::array<ElementType, 94> types{};
  constexpr std::array<std::uint8_t, 32> kNodes{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                                8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  for (std::size_t i = 0; i < kNodes.size(); ++i) types[i].nodes = kNodes[i];
  types[92].nodes = 64;
  types[93].nodes = 125;
  for (const std::size_t triangle : {2, 9, 20, 21, 22, 23, 24, 25}) types[triangle].corners = 3;
  for (const std::size_t quadrilateral : {3, 10, 16}) types[quadrilateral].corners = 4;
  return types;
}();

/// The numbers of a file that is text.
class MshText {
 public:
  explicit MshText(std::string_view content) : tokens_(content) {}

  std::string_view word() { return tokens_.next(); }
  /// Takes the rest of the current line, or the next line if nothing is left of this one.
  std::string_view line() {
    while (trim(tokens_.rest_of_line()).empty() && tokens_.next_line()) {
    }
    const std::string_view rest = tokens_.rest_of_line();
    tokens_.next_line();
    return rest;
  }
  std::int64_t integer(const char* what) { return tokens_.integer<std::int64_t>(what); }
  std::uint64_t size(const char* what) { return tokens_.integer<std::uint64_t>(what); }
  double coordinate() { return tokens_.coordinate(); }
  /// Goes behind the line that ends a section.
  /// Output: false if there is none.
  bool skip_to(std::string_view end) {
    while (tokens_.next_line()) {
      std::string_view line = tokens_.rest_of_line();
      if (next_token(line) != end) continue;
      tokens_.next();
      return true;
    }
    return false;
  }
  Place place() const { return tokens_.place(); }
  std::size_t offset() const { return tokens_.offset(); }

  static constexpr std::size_t kMinNode = 8;     ///< bytes of the shortest node: `1 0 0 0`
  static constexpr std::size_t kMinElement = 6;  ///< bytes of the shortest triangle: `1 1 1`

 private:
  TextTokens tokens_;
};

/// The numbers of a binary file, from the end of the line that tells its version.
class MshBinary {
 public:
  MshBinary(std::string_view content, std::size_t offset)
      : content_(content), order_(order_at(content, offset)), bytes_(content, offset + sizeof(std::int32_t), order_) {}

  std::string_view word() {
    std::string_view rest = content_.substr(bytes_.offset());
    const std::size_t begin = std::min(rest.find_first_not_of(" \t\r\n"), rest.size());
    rest.remove_prefix(begin);
    const std::size_t end = std::min(rest.find_first_of(" \t\r\n"), rest.size());
    // The data of a section begins behind the line end.
    const std::size_t line_end = std::min(rest.find('\n'), rest.size());
    bytes_.skip(begin + (line_end == rest.size() || trim(rest.substr(end, line_end - end)) != "" ? end : line_end + 1));
    return rest.substr(0, end);
  }
  std::string_view line() {
    const std::string_view rest = content_.substr(bytes_.offset());
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    bytes_.skip(std::min(end + 1, rest.size()));
    return rest.substr(0, end);
  }
  std::int64_t integer(const char*) { return bytes_.take<std::int32_t>(); }
  std::uint64_t size(const char*) { return bytes_.take<std::uint64_t>(); }
  double coordinate() { return bytes_.take<double>(); }
  bool skip_to(std::string_view end) {
    const std::size_t found = content_.find(end, bytes_.offset());
    if (found == std::string_view::npos) return false;
    bytes_.skip(found + end.size() - bytes_.offset());
    return true;
  }
  Place place() const { return bytes_.place(); }
  std::size_t offset() const { return bytes_.offset(); }

  static constexpr std::size_t kMinNode = 24;
  static constexpr std::size_t kMinElement = 12;

 private:
  /// The byte order is that in which the number 1 stands.
  static ByteOrder order_at(std::string_view content, std::size_t offset) {
    ByteReader one(content, offset, ByteOrder::kLittle);
    return one.take<std::int32_t>() == 1 ? ByteOrder::kLittle : ByteOrder::kBig;
  }

  std::string_view content_;
  ByteOrder order_;
  ByteReader bytes_;
};

template <class Source>
class MshReader {
 public:
  MshReader(Source source, bool is_new, std::string_view content, const ReadLimits& limits, RunControl& control)
      : source_(std::move(source)),
        is_new_(is_new),
        content_(content),
        limits_(limits),
        control_(control),
        builder_(limits, control) {}

  ReadResult read() {
    for (std::string_view word = source_.word(); !word.empty(); word = source_.word()) {
      if (!word.starts_with('$')) throw error("a section was expected, found " + cited(word));
      const std::string end = "$End" + std::string(word.substr(1, 64));
      if (word == "$PhysicalNames") {
        read_names();
      } else if (word == "$Entities" && is_new_) {
        read_entities();
      } else if (word == "$Nodes") {
        is_new_ ? read_nodes_41() : read_nodes_22();
      } else if (word == "$Elements") {
        is_new_ ? read_elements_41() : read_elements_22();
      } else {
        if (!source_.skip_to(end)) throw error("the section " + cited(word) + " does not end");
        continue;
      }
      if (const std::string_view found = source_.word(); found != end)
        throw error(end + " was expected, " + (found.empty() ? "but the data ends" : "found " + cited(found)));
    }
    ReadResult result;
    result.mesh = builder_.take();
    result.mesh.labels.group = groups_.take(names_);
    record_dropped("elements that are no faces were dropped", other_elements_, result.diagnostics);
    record_dropped("nodes on the edges of faces were dropped; number of faces that had them", curved_,
                   result.diagnostics);
    record_dropped("surfaces that belong to several physical groups have the first one; number of them", more_groups_,
                   result.diagnostics);
    return result;
  }

 private:
  void read_names() {
    std::string_view count_line = source_.line();
    std::uint64_t count = 0;
    const std::string_view token = next_token(count_line);
    std::from_chars(token.data(), token.data() + token.size(), count);
    for (std::uint64_t i = 0; i < count; ++i) {
      tick();
      std::string_view rest = source_.line();
      const std::string_view dimension = next_token(rest), tag = next_token(rest);
      std::int64_t number = 0;
      std::from_chars(tag.data(), tag.data() + tag.size(), number);
      const std::size_t begin = rest.find('"'), end = rest.rfind('"');
      if (begin == std::string_view::npos || end == begin) throw error("a physical name without quotes");
      const std::string_view name = rest.substr(begin + 1, end - begin - 1);
      if (dimension == "2" && name.size() <= kMaxNameLength) names_.try_emplace(number, name);
    }
  }

  void read_entities() {
    std::array<std::uint64_t, 4> counts;
    for (std::uint64_t& count : counts) count = source_.size("the number of entities");
    for (std::size_t dimension = 0; dimension < counts.size(); ++dimension)
      for (std::uint64_t i = 0; i < counts[dimension]; ++i) {
        tick();
        const std::int64_t tag = source_.integer("the tag of an entity");
        for (int j = dimension == 0 ? 3 : 6; j > 0; --j) (void)source_.coordinate();
        const std::uint64_t groups = source_.size("the number of physical groups");
        for (std::uint64_t j = 0; j < groups; ++j) {
          tick();
          const std::int64_t group = source_.integer("the tag of a physical group");
          // A negative number is the group of the turned surface.
          if (dimension == 2 && j == 0) group_of_surface_.try_emplace(tag, std::abs(group));
        }
        if (dimension == 2 && groups > 1) ++more_groups_;
        if (dimension == 0) continue;
        for (std::uint64_t j = source_.size("the number of bounding entities"); j > 0; --j) {
          tick();
          (void)source_.integer("the tag of a bounding entity");
        }
      }
  }

  void begin_nodes(std::uint64_t count) {
    if (vertices_) throw error("there is a second list of nodes");
    vertices_ = count;
    builder_.announce(count, 0, content_.size() / Source::kMinNode, 0, source_.place());
  }
  void add_node(std::uint64_t tag) { tags_.add(tag); }
  void add_position() {
    tick();
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = source_.coordinate();
    builder_.add_vertex(p, source_.place());
  }
  void end_nodes() {
    if (const auto twice = tags_.sort(control_)) throw error("two nodes have the number " + std::to_string(*twice));
  }

  void read_nodes_22() {
    begin_nodes(count_22("the number of nodes"));
    for (std::uint64_t i = 0; i < *vertices_; ++i) {
      add_node(tag_of(source_.integer("the number of a node")));
      add_position();
    }
    end_nodes();
  }
  void read_nodes_41() {
    const std::uint64_t blocks = source_.size("the number of blocks");
    begin_nodes(source_.size("the number of nodes"));
    source_.size("the smallest number"), source_.size("the largest number");
    std::uint64_t left = *vertices_;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      tick();
      const std::int64_t dimension = source_.integer("a dimension");
      (void)source_.integer("the tag of an entity");
      const bool is_parametric = source_.integer("0 or 1") != 0;
      const std::uint64_t count = source_.size("the number of nodes");
      if (dimension < 0 || dimension > 3) throw error("an entity of dimension " + std::to_string(dimension));
      if (count > left) throw error("the blocks have more nodes than there are");
      left -= count;
      for (std::uint64_t i = 0; i < count; ++i) {
        tick();
        add_node(source_.size("the number of a node"));
      }
      for (std::uint64_t i = 0; i < count; ++i) {
        add_position();
        for (std::int64_t j = 0; is_parametric && j < dimension; ++j) (void)source_.coordinate();
      }
    }
    if (left > 0) throw error("the blocks have fewer nodes than there are");
    end_nodes();
  }

  void begin_elements(std::uint64_t count) {
    if (!vertices_) throw error("there are elements before the nodes");
    if (has_elements_) throw error("there is a second list of elements");
    has_elements_ = true;
    builder_.announce(*vertices_, std::min(count, limits_.max_faces), 0, content_.size() / Source::kMinElement,
                      source_.place());
  }
  ElementType type_of(std::int64_t number) const {
    const bool is_known = number > 0 && number < static_cast<std::int64_t>(kElementTypes.size());
    const ElementType type = is_known ? kElementTypes[static_cast<std::size_t>(number)] : ElementType{};
    if (type.nodes == 0) throw error("an element of the type " + std::to_string(number) + ", which is not known");
    return type;
  }
  /// Reads the nodes of an element.
  template <class TakeTag>
  void read_element(ElementType type, std::int64_t group, const TakeTag& take_tag) {
    tick();
    if (type.corners == 0) {
      ++other_elements_;
      for (int i = 0; i < type.nodes; ++i) (void)take_tag();
      return;
    }
    if (builder_.mesh().face_count() == limits_.max_faces)
      throw too_large_error(source_.place(), "faces", limits_.max_faces);
    builder_.begin_face(type.corners, source_.place());
    for (int i = 0; i < type.nodes; ++i) {
      const std::uint64_t tag = take_tag();
      if (i >= type.corners) continue;
      const std::int64_t vertex = tags_.find(tag);
      if (vertex < 0) {
        throw read_error(source_.place(), Code::kIndexOutOfRange,
                         "a face refers to node " + std::to_string(tag) + ", which is not there")
            .at_element(builder_.mesh().face_count() - 1);
      }
      builder_.add_corner(vertex, source_.place());
    }
    if (type.nodes > type.corners) ++curved_;
    groups_.add_face(group);
  }

  void read_elements_22() {
    const std::uint64_t count = count_22("the number of elements");
    begin_elements(count);
    const auto take_tag = [&] { return tag_of(source_.integer("the number of a node")); };
    constexpr bool kIsText = std::is_same_v<Source, MshText>;
    for (std::uint64_t done = 0; done < count;) {
      // In text each element has its own type and number of tags, in binary data a block of elements has them.
      std::uint64_t in_block = 1;
      if constexpr (kIsText) (void)source_.integer("the number of an element");
      const ElementType type = type_of(source_.integer("the type of an element"));
      if constexpr (!kIsText) in_block = tag_of(source_.integer("the number of elements"));
      const std::int64_t tags = source_.integer("the number of tags");
      if (in_block == 0 || in_block > count - done) throw error("a block with a wrong number of elements");
      for (std::uint64_t i = 0; i < in_block; ++i) {
        if constexpr (!kIsText) (void)source_.integer("the number of an element");
        std::int64_t group = 0;
        for (std::int64_t t = 0; t < tags; ++t) {
          tick();
          const std::int64_t tag = source_.integer("a tag");
          if (t == 0) group = std::abs(tag);
        }
        read_element(type, group, take_tag);
      }
      done += in_block;
    }
  }
  void read_elements_41() {
    const std::uint64_t blocks = source_.size("the number of blocks");
    const std::uint64_t count = source_.size("the number of elements");
    begin_elements(count);
    source_.size("the smallest number"), source_.size("the largest number");
    const auto take_tag = [&] { return source_.size("the number of a node"); };
    for (std::uint64_t b = 0; b < blocks; ++b) {
      tick();
      const std::int64_t dimension = source_.integer("a dimension");
      const std::int64_t entity = source_.integer("the tag of an entity");
      const ElementType type = type_of(source_.integer("the type of the elements"));
      const auto group = dimension == 2 ? group_of_surface_.find(entity) : group_of_surface_.end();
      for (std::uint64_t i = source_.size("the number of elements"); i > 0; --i) {
        (void)source_.size("the number of an element");
        read_element(type, group == group_of_surface_.end() ? 0 : group->second, take_tag);
      }
    }
  }

  /// Takes a count. Binary files of version 2 have these in a line of text.
  std::uint64_t count_22(const char* what) {
    if constexpr (std::is_same_v<Source, MshText>) return source_.size(what);
    std::string_view line = source_.line();
    const std::string_view token = next_token(line);
    std::uint64_t count = 0;
    const auto [stop, status] = std::from_chars(token.data(), token.data() + token.size(), count);
    if (status != std::errc()) throw error(std::string(what) + " was expected, found " + cited(token));
    return count;
  }
  std::uint64_t tag_of(std::int64_t number) const {
    if (number < 0) throw error("a negative number " + std::to_string(number));
    return static_cast<std::uint64_t>(number);
  }

  void tick() { builder_.tick(source_.offset(), content_.size()); }
  Error error(const std::string& message) const { return read_error(source_.place(), Code::kInvalidMesh, message); }

  Source source_;
  bool is_new_;
  std::string_view content_;
  const ReadLimits& limits_;
  RunControl& control_;
  MeshBuilder builder_;
  NodeTags tags_;
  NumberedLabels groups_;
  NumberedLabels::Names names_;
  std::map<std::int64_t, std::int64_t> group_of_surface_;
  std::optional<std::uint64_t> vertices_;
  bool has_elements_ = false;
  std::uint64_t other_elements_ = 0, curved_ = 0, more_groups_ = 0;
};

}  // namespace

ReadResult read_msh(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  // The head is text in both kinds of files.
  constexpr std::size_t kLongestHead = 4096;
  TextLines lines(content.substr(0, kLongestHead));
  const auto error = [&](const std::string& message) {
    return read_error(Place::line(lines.number()), Code::kInvalidMesh, message);
  };
  while (lines.next() && trim(lines.line()) != "$MeshFormat") {
  }
  if (!lines.next()) throw error("not Gmsh's format: the text has no line $MeshFormat with a line behind it");
  std::string_view line = lines.line();
  const std::string_view version = next_token(line), kind = next_token(line), size = next_token(line);
  const bool is_new = version == "4.1";
  if (!is_new && version != "2" && !version.starts_with("2."))
    throw error("version " + cited(version) + " of Gmsh's format is not read; 2.2 and 4.1 are");
  if (kind == "1" && size == "8") {
    MshBinary source(content, lines.offset());
    if (source.word() != "$EndMeshFormat") throw error("the section $MeshFormat does not end");
    return MshReader(source, is_new, content, limits, control).read();
  }
  if (kind != "0") throw error("a format that is neither text (0) nor binary with numbers of 8 bytes (1 8)");
  return MshReader(MshText(content), is_new, content, limits, control).read();
}

}  // namespace remesh
