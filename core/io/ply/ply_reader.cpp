#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/io/common/bytes.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"
#include "core/io/common/text_lines.h"
#include "core/io/ply/ply.h"

namespace remesh {
namespace {

enum class PlyEncoding { kText, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

constexpr bool is_real(PlyType type) { return type == PlyType::kFloat32 || type == PlyType::kFloat64; }
constexpr std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8: return 1;
    case PlyType::kInt16:
    case PlyType::kUint16: return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32: return 4;
    case PlyType::kFloat64: return 8;
  }
  return 0;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kInt8;
  std::optional<PlyType> count_type;  ///< type of the count, if the property is a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  ///< one or more if count > 0
  std::uint64_t line = 0;               ///< the line of its declaration

  /// The smallest size of a record in bytes, which it has if its lists are empty.
  std::size_t least_size() const;
  bool has_lists() const;
  /// The index of the property of that name.
  /// Output: nothing if there is none.
  std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  ///< the text after the word `comment` and a blank
  std::size_t size = 0;               ///< bytes, including the end of the last line
  std::uint64_t lines = 0;
};

/// These limits exceed every real file. Each property costs time for every record.
constexpr std::size_t kMaxProperties = 1024;
constexpr std::size_t kMaxElements = 64;
constexpr std::size_t kMaxComments = 1 << 16;

/// Parses the name of a type. Each type has two names.
std::optional<PlyType> type_from_name(std::string_view name) {
  constexpr std::pair<std::string_view, PlyType> kTypes[] = {
      {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64}};
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

class HeaderParser {
 public:
  explicit HeaderParser(std::string_view content) : content_(content), lines_(content) {}

  PlyHeader parse() {
    if (!lines_.next() || trim(lines_.line()) != "ply") {
      throw read_error(Place::line(1), Code::kInvalidMesh, "not PLY: the first line is not \"ply\"");
    }
    const bool has_lone_returns = lines_.offset() > 0 && content_[lines_.offset() - 1] == '\r';
    while (lines_.next()) {
      std::string_view rest = lines_.line();
      const std::string_view keyword = next_token(rest);
      if (keyword == "comment" || keyword == "obj_info") {
        if (!rest.empty()) rest.remove_prefix(1);
        if (keyword == "comment" && header_.comments.size() < kMaxComments) header_.comments.emplace_back(rest);
        continue;
      }
      lines_.check_is_text();
      if (keyword == "end_header") return finish(has_lone_returns);
      if (keyword == "format") {
        take_format(rest);
      } else if (keyword == "element") {
        take_element(rest);
      } else if (keyword == "property") {
        take_property(rest);
      } else if (!keyword.empty()) {
        throw error("not a line of a PLY header: " + cited(lines_.line()));
      }
    }
    throw error("the header has no \"end_header\"");
  }

 private:
  PlyHeader finish(bool has_lone_returns) {
    if (!has_format_) throw error("the header has no \"format\"");
    for (const PlyElement& element : header_.elements) {
      if (element.count > 0 && element.properties.empty()) {
        throw read_error(Place::line(element.line), Code::kInvalidMesh, "an element without properties");
      }
    }
    header_.size = lines_.offset();
    // If lines end in CR alone, an LF after the last one is the first byte of the data.
    if (has_lone_returns && content_[header_.size - 1] == '\n') --header_.size;
    header_.lines = lines_.number();
    return std::move(header_);
  }

  void take_format(std::string_view rest) {
    const std::string_view name = next_token(rest);
    if (has_format_) throw error("a second \"format\"");
    has_format_ = true;
    if (name == "ascii") {
      header_.encoding = PlyEncoding::kText;
    } else if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      throw error("a format that is not known: " + cited(name));
    }
    if (next_token(rest) != "1.0") throw error("a version of PLY that is not 1.0");
  }

  void take_element(std::string_view rest) {
    PlyElement element;
    element.name = next_token(rest);
    const std::string_view count = next_token(rest);
    const char* const end = count.data() + count.size();
    const auto [stop, status] = std::from_chars(count.data(), end, element.count);
    if (element.name.empty() || status != std::errc() || stop != end) {
      throw error("an element takes a name and a count");
    }
    if (header_.elements.size() == kMaxElements) throw error("too many elements");
    for (const PlyElement& other : header_.elements) {
      if (other.name == element.name) throw error("the element " + cited(element.name) + " is declared twice");
    }
    element.line = lines_.number();
    header_.elements.push_back(std::move(element));
  }

  void take_property(std::string_view rest) {
    if (header_.elements.empty()) throw error("a property before the first element");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view type = next_token(rest);
    if (type == "list") {
      property.count_type = take_type(next_token(rest));
      if (is_real(*property.count_type)) throw error("a list whose length is no whole number");
      type = next_token(rest);
    }
    property.type = take_type(type);
    property.name = next_token(rest);
    if (property.name.empty()) throw error("a property without a name");
    if (element.find(property.name)) throw error("the property " + cited(property.name) + " is declared twice");
    if (element.properties.size() == kMaxProperties) throw error("too many properties");
    element.properties.push_back(std::move(property));
  }

  PlyType take_type(std::string_view name) const {
    if (const auto type = type_from_name(name)) return *type;
    throw error("a type that is not known: " + cited(name));
  }

  Error error(const std::string& message) const {
    return read_error(Place::line(lines_.number()), Code::kInvalidMesh, message);
  }

  std::string_view content_;
  TextLines lines_;
  PlyHeader header_;
  bool has_format_ = false;
};

std::size_t PlyElement::least_size() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties) size += size_of(property.count_type.value_or(property.type));
  return size;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return bool(p.count_type); });
}

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return i;
  }
  return std::nullopt;
}

/// Parses the header of a PLY file.
/// Errors: kInvalidMesh, with the line - not a PLY header.
/// Cost:   O(header).
PlyHeader parse_ply_header(std::string_view content) { return HeaderParser(content).parse(); }

/// The records of a text, one in each line.
class TextRecords {
 public:
  TextRecords(std::string_view content, const PlyHeader& header, RunControl& control)
      : content_(content),
        header_size_(header.size),
        header_lines_(header.lines),
        lines_(content.substr(header.size)),
        check_(control) {}

  void begin_record() {
    do {
      if (!lines_.next()) throw error("the text ends before the last record");
      lines_.check_is_text();
      rest_ = trim(lines_.line());
    } while (rest_.empty());
  }
  void end_record() const {
    if (!trim(rest_).empty()) throw error("more values than the header announces: " + cited(rest_));
  }

  double take_real(PlyType) { return parse_coordinate(take_token(), place()); }
  std::int64_t take_integer(PlyType) {
    const std::string_view token = take_token();
    std::int64_t value = 0;
    const char* const end = token.data() + token.size();
    const auto [stop, status] = std::from_chars(token.data(), end, value);
    if (status != std::errc() || stop != end) throw error("not a whole number: " + cited(token));
    return value;
  }
  void skip(PlyType, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      check_();
      take_token();
    }
  }
  /// Text records have no fixed size by which to skip them.
  bool skip_element(const PlyElement&) { return false; }

  void finish(std::size_t, std::vector<Diagnostic>& diagnostics) {
    while (lines_.next()) {
      if (!trim(lines_.line()).empty()) throw error("text after the last record: " + cited(lines_.line()));
    }
    record_padding(content_, diagnostics);
  }

  std::size_t offset() const { return header_size_ + lines_.offset(); }
  Place place() const { return Place::line(header_lines_ + lines_.number()); }

 private:
  std::string_view take_token() {
    const std::string_view token = next_token(rest_);
    if (token.empty()) throw error("fewer values than the header announces");
    return token;
  }
  Error error(const std::string& message) const { return read_error(place(), Code::kInvalidMesh, message); }

  std::string_view content_;
  std::size_t header_size_;
  std::uint64_t header_lines_;
  TextLines lines_;
  StopCheck check_;
  std::string_view rest_;
};

/// The records of binary data.
class BinaryRecords {
 public:
  BinaryRecords(std::string_view content, const PlyHeader& header, RunControl&)
      : content_(content),
        bytes_(content, header.size,
               header.encoding == PlyEncoding::kLittleEndian ? ByteOrder::kLittle : ByteOrder::kBig) {}

  void begin_record() {}
  void end_record() const {}

  double take_real(PlyType type) {
    if (type == PlyType::kFloat32) return bytes_.take<float>();
    if (type == PlyType::kFloat64) return bytes_.take<double>();
    return static_cast<double>(take_integer(type));
  }
  std::int64_t take_integer(PlyType type) {
    switch (type) {
      case PlyType::kInt8: return bytes_.take<std::int8_t>();
      case PlyType::kUint8: return bytes_.take<std::uint8_t>();
      case PlyType::kInt16: return bytes_.take<std::int16_t>();
      case PlyType::kUint16: return bytes_.take<std::uint16_t>();
      case PlyType::kInt32: return bytes_.take<std::int32_t>();
      case PlyType::kUint32: return bytes_.take<std::uint32_t>();
      case PlyType::kFloat32:
      case PlyType::kFloat64: break;
    }
    throw read_error(place(), Code::kInvalidMesh, "a whole number that the header calls a real one");
  }
  void skip(PlyType type, std::uint64_t count) { bytes_.skip(count * size_of(type)); }
  bool skip_element(const PlyElement& element) {
    if (element.has_lists() || element.count == 0) return false;
    if (element.count > bytes_.left() / element.least_size()) {
      throw truncated_error(content_.size(), "inside the element " + cited(element.name));
    }
    bytes_.skip(element.count * element.least_size());
    return true;
  }
  void finish(std::size_t least_record, std::vector<Diagnostic>& diagnostics) const {
    record_trailing_bytes(content_, bytes_.offset(), least_record, diagnostics);
  }

  std::size_t offset() const { return bytes_.offset(); }
  Place place() const { return bytes_.place(); }

 private:
  std::string_view content_;
  ByteReader bytes_;
};

/// A property of faces that is used as a label.
struct LabelProperty {
  std::string_view kind;
  LabelSet FaceLabels::*set;
  LabelCollector labels;
  std::optional<std::int64_t> last_value;
  std::map<std::int64_t, std::string> names;
};

/// Finds the names in comments such as `group 3 lid`.
void find_names(const PlyHeader& header, LabelProperty& label) {
  for (const std::string& comment : header.comments) {
    std::string_view rest = comment;
    if (next_token(rest) != label.kind) continue;
    const std::string_view number = next_token(rest);
    std::int64_t value = 0;
    const char* const end = number.data() + number.size();
    const auto [stop, status] = std::from_chars(number.data(), end, value);
    if (status != std::errc() || stop != end) continue;
    if (!rest.empty()) rest.remove_prefix(1);
    if (rest.size() <= kMaxNameLength) label.names.try_emplace(value, rest);
  }
}

template <class Records>
class PlyReader {
 public:
  PlyReader(std::string_view content, const PlyHeader& header, const ReadLimits& limits, RunControl& control)
      : content_size_(content.size()), header_(header), records_(content, header, control), builder_(limits, control) {
    if (limits.ply_labels) group_names_.assign(limits.ply_labels->begin(), limits.ply_labels->end());
  }

  ReadResult read() {
    announce();
    std::size_t least_record = 1;
    for (const PlyElement& element : header_.elements) {
      if (element.count > 0) least_record = least_face_size(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        skip_element(element);
      }
    }
    records_.finish(least_record, diagnostics_);
    ReadResult result;
    result.mesh = builder_.take();
    for (LabelProperty& label : labels_) result.mesh.labels.*label.set = label.labels.take();
    result.diagnostics = std::move(diagnostics_);
    return result;
  }

 private:
  /// The smallest size of a face's record in bytes. Its lists have at least three entries.
  static std::size_t least_face_size(const PlyElement& element) {
    std::size_t size = element.least_size();
    for (const PlyProperty& property : element.properties) {
      if (property.count_type) size += 3 * size_of(property.type);
    }
    return size;
  }

  void announce() {
    const PlyElement* vertices = nullptr;
    const PlyElement* faces = nullptr;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") vertices = &element;
      if (element.name == "face") faces = &element;
    }
    const Place end = Place::line(header_.lines);
    if (vertices == nullptr) throw read_error(end, Code::kInvalidMesh, "the header has no element \"vertex\"");
    const std::size_t data = content_size_ - header_.size;
    // In text, each number takes at least a digit and a blank.
    const bool is_text = header_.encoding == PlyEncoding::kText;
    const auto room = [&](const PlyElement* element) {
      return element == nullptr ? 0 : data / (is_text ? 2 * element->properties.size() : element->least_size());
    };
    const Place place = Place::line(std::max(vertices->line, faces == nullptr ? 0 : faces->line));
    builder_.announce(vertices->count, faces == nullptr ? 0 : faces->count, vertices->count == 0 ? 0 : room(vertices),
                      faces == nullptr || faces->count == 0 ? 0 : room(faces), place);
  }

  void read_vertices(const PlyElement& element) {
    if (element.count == 0) return;
    constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
    constexpr int kNoAxis = -1;
    std::vector<int> axis_of(element.properties.size(), kNoAxis);
    for (int axis = 0; axis < 3; ++axis) {
      const auto property = element.find(kAxes[axis]);
      if (!property || element.properties[*property].count_type) {
        throw read_error(Place::line(element.line), Code::kInvalidMesh,
                         "the vertices have no numeric property \"" + std::string(kAxes[axis]) + "\"");
      }
      axis_of[*property] = axis;
    }
    for (std::uint64_t v = 0; v < element.count; ++v) {
      builder_.tick(records_.offset(), content_size_);
      records_.begin_record();
      Vec3 position;
      for (std::size_t i = 0; i < axis_of.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        if (axis_of[i] == kNoAxis) {
          skip_property(property);
        } else {
          position[axis_of[i]] = records_.take_real(property.type);
        }
      }
      builder_.add_vertex(position, records_.place());
      records_.end_record();
    }
    for (std::size_t i = 0; i < axis_of.size(); ++i) {
      if (axis_of[i] == kNoAxis) record_dropped(element, &element.properties[i]);
    }
  }

  /// Finds the property that has the labels of a kind. Other programs have other names for groups.
  std::optional<std::size_t> find_label(const PlyElement& element, std::string_view kind) const {
    const auto find = [&](std::string_view name) {
      const auto property = element.find(name);
      const bool is_whole_number =
          property && !element.properties[*property].count_type && !is_real(element.properties[*property].type);
      return is_whole_number ? property : std::nullopt;
    };
    if (kind != "group") return find(kind);
    std::optional<std::size_t> found;
    for (std::size_t i = 0; !found && i < group_names_.size(); ++i) found = find(group_names_[i]);
    return found;
  }

  void read_faces(const PlyElement& element) {
    if (element.count == 0) return;
    const std::size_t corners = find_corners(element);
    std::vector<LabelProperty*> label_of(element.properties.size(), nullptr);
    for (LabelProperty& label : labels_) {
      const auto property = find_label(element, label.kind);
      if (!property || label_of[*property] != nullptr) continue;
      label_of[*property] = &label;
      find_names(header_, label);
    }
    for (std::uint64_t f = 0; f < element.count; ++f) {
      builder_.tick(records_.offset(), content_size_);
      records_.begin_record();
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        if (i == corners) {
          read_corners(property);
        } else if (label_of[i] != nullptr) {
          read_label(*label_of[i], property, f);
        } else {
          skip_property(property);
        }
      }
      records_.end_record();
    }
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (i != corners && label_of[i] == nullptr) record_dropped(element, &element.properties[i]);
    }
  }

  static std::size_t find_corners(const PlyElement& element) {
    for (const std::string_view name : {"vertex_indices", "vertex_index"}) {
      const auto property = element.find(name);
      if (property && element.properties[*property].count_type && !is_real(element.properties[*property].type)) {
        return *property;
      }
    }
    throw read_error(Place::line(element.line), Code::kInvalidMesh,
                     "the faces have no list \"vertex_indices\" of whole numbers");
  }

  void read_corners(const PlyProperty& list) {
    const Place place = records_.place();
    const std::int64_t count = records_.take_integer(*list.count_type);
    builder_.begin_face(count < 0 ? 0 : static_cast<std::uint64_t>(count), place);
    for (std::int64_t i = 0; i < count; ++i) {
      builder_.tick(records_.offset(), content_size_);
      builder_.add_corner(records_.take_integer(list.type), place);
    }
  }

  void read_label(LabelProperty& label, const PlyProperty& property, std::uint64_t face) {
    const std::int64_t value = records_.take_integer(property.type);
    if (label.last_value != value) {
      label.last_value = value;
      const auto named = label.names.find(value);
      label.labels.name(named == label.names.end() ? std::to_string(value) : named->second);
    }
    label.labels.add_face(static_cast<std::size_t>(face));
  }

  void skip_property(const PlyProperty& property) {
    if (!property.count_type) return records_.skip(property.type, 1);
    const Place place = records_.place();
    const std::int64_t count = records_.take_integer(*property.count_type);
    if (count < 0) throw read_error(place, Code::kInvalidMesh, "a list with a negative length");
    records_.skip(property.type, static_cast<std::uint64_t>(count));
  }

  void skip_element(const PlyElement& element) {
    if (element.count == 0) return;
    if (element.name == "tristrips") {
      throw read_error(Place::line(element.line), Code::kInvalidMesh,
                       "triangle strips cannot be read; the mesh needs an element \"face\"");
    }
    record_dropped(element, nullptr);
    if (records_.skip_element(element)) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      builder_.tick(records_.offset(), content_size_);
      records_.begin_record();
      for (const PlyProperty& property : element.properties) skip_property(property);
      records_.end_record();
    }
  }

  void record_dropped(const PlyElement& element, const PlyProperty* property) {
    const std::string what = property == nullptr ? "" : "property " + cited(property->name) + " of ";
    diagnostics_.push_back({DiagnosticCode::kAttributeDropped,
                            element.count,
                            {},
                            what + "element " + cited(element.name) + " dropped: " + std::to_string(element.count)});
  }

  std::size_t content_size_;
  const PlyHeader& header_;
  Records records_;
  MeshBuilder builder_;
  std::vector<Diagnostic> diagnostics_;
  std::vector<std::string_view> group_names_{"group", "group_id", "layer_id", "material_index"};
  std::array<LabelProperty, 3> labels_{LabelProperty{"object", &FaceLabels::object, {}, {}, {}},
                                       LabelProperty{"group", &FaceLabels::group, {}, {}, {}},
                                       LabelProperty{"material", &FaceLabels::material, {}, {}, {}}};
};

}  // namespace

ReadResult read_ply(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  const PlyHeader header = parse_ply_header(content);
  return header.encoding == PlyEncoding::kText ? PlyReader<TextRecords>(content, header, limits, control).read()
                                               : PlyReader<BinaryRecords>(content, header, limits, control).read();
}

}  // namespace remesh
