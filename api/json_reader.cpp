#include "api/json_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "api/json_arrays.h"
#include "api/quoting.h"
#include "api/request_code.h"
#include "core/base/error.h"

namespace remesh::api {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxDepth = 64;
constexpr std::size_t kMaxNamedKeys = 8;
constexpr std::uint64_t kMaxIndex = VertexId::kInvalid - 1;

/// Iterates over the text for the parser. All copies share one position, so the handler can see how far the parser
/// is, and can move it.
class TrackedIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  explicit TrackedIterator(const char** at) : at_(at) {}
  reference operator*() const { return **at_; }
  TrackedIterator& operator++() {
    ++*at_;
    return *this;
  }
  friend bool operator==(const TrackedIterator& a, const TrackedIterator& b) { return *a.at_ == *b.at_; }

 private:
  const char** at_;
};

/// How the arrays of vertices and faces are read. The parser's events handle any JSON and can explain errors. The
/// plain readers take a sixth of the time.
enum class Arrays { kByEvents, kPlain };

/// Says whether the mesh is built or its text is only checked.
enum class Building { kMesh, kNothing };

enum class Place {
  kRoot,
  kMesh,
  kVertices,
  kVertex,
  kFaces,
  kFace,
  kFaceGroups,
  kLabels,
  kLabelSet,
  kLabelNames,
  kLabelFaces,
  kOptions,
  kOptionList
};

enum class Key { kMesh, kOptions, kVertices, kFaces, kFaceGroups, kLabels, kUnknown };
constexpr std::array<std::string_view, 6> kKeyNames{"mesh", "options", "vertices", "faces", "face_groups", "labels"};

/// A number from the parser. `token` is empty for integers.
struct Number {
  double value;
  bool is_integer;
  bool is_negative;
  std::uint64_t magnitude;
  std::string_view token;

  /// Treats 2.0 and 1e0 as integers, as JSON Schema does.
  Number as_integer() const {
    constexpr double kLargest = 0x1p53;  // beyond this, a double represents several integers
    if (is_integer || value != std::floor(value) || std::fabs(value) > kLargest) return *this;
    return {value, true, value < 0, static_cast<std::uint64_t>(std::fabs(value)), {}};
  }
  std::string text() const {
    return is_integer ? (is_negative ? "-" : "") + std::to_string(magnitude) : std::string(token);
  }
};

/// Receives the parser's events. `stack_` tells to which part of the document they belong.
class Handler final : public nlohmann::json_sax<Json> {
 public:
  Handler(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options, Place root,
          Arrays arrays, Building building)
      : text_(text),
        at_(text.data()),
        end_(text.data() + text.size()),
        limits_(limits),
        control_(control),
        options_(options),
        root_(root),
        arrays_(arrays),
        building_(building) {}

  void run() { Json::sax_parse(TrackedIterator(&at_), TrackedIterator(&end_), this); }

  ReadResult take_mesh();

  // These functions receive the parser's events.
  bool null() override { return scalar(ValueKind::kNull, "null"); }
  bool boolean(bool value) override { return scalar(ValueKind::kBoolean, value ? "true" : "false"); }
  bool string(std::string& value) override { return scalar(ValueKind::kString, value); }
  bool binary(Json::binary_t&) override { return false; }  // JSON text contains none
  bool number_unsigned(std::uint64_t value) override {
    return number({static_cast<double>(value), true, false, value, {}});
  }
  bool number_integer(std::int64_t value) override {
    const auto bits = static_cast<std::uint64_t>(value);
    return number({static_cast<double>(value), true, value < 0, value < 0 ? 0 - bits : bits, {}});
  }
  bool number_float(double value, const std::string& token) override { return number({value, false, false, 0, token}); }
  bool start_object(std::size_t) override { return start(/*is_object=*/true); }
  bool start_array(std::size_t) override { return start(/*is_object=*/false); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool key(std::string& name) override;
  bool parse_error(std::size_t position, const std::string& token, const Json::exception& error) override;

 private:
  bool scalar(ValueKind kind, std::string_view text);
  bool number(const Number& number);
  bool start(bool is_object);
  bool end();

  void enter_child(bool is_object);
  void read_plain_array();
  void open_vertex();
  void close_vertex();
  void open_face();
  void close_face();
  void add_corner(const Number& number);
  void add_face_group(const Number& number);
  bool label_key(const std::string& name);
  void add_label_name(std::string_view text);
  void add_label_face(const Number& number);
  void add_list_item(std::string_view text);
  void skip_key(const std::string& name);
  void check_indices() const;
  void check_labels(std::string_view kind, const LabelSet& labels) const;
  void tick();

  std::uint64_t vertex_count() const { return mesh_.positions.size(); }
  std::uint64_t face_count() const { return mesh_.face_count(); }
  std::string_view expected_of_key() const;

  std::uint64_t line() const;
  [[noreturn]] void fail(Code code, const std::string& message) const;
  [[noreturn]] void fail_json(const std::string& message) const { fail(as_code(RequestCode::kMalformedJson), message); }
  [[noreturn]] void fail_shape(const std::string& message) const { fail(Code::kInvalidMesh, message); }
  [[noreturn]] void fail_at(Code code, std::uint64_t element, const std::string& message) const;
  /// Throws the error for a value of a wrong kind at the current place of the document.
  [[noreturn]] void fail_value() const;

  std::string_view text_;
  const char* at_;
  const char* end_;
  ReadLimits limits_;
  RunControl& control_;
  OptionReader& options_;
  Place root_;
  Arrays arrays_;
  Building building_;

  std::vector<Place> stack_;
  std::size_t skipped_depth_ = 0;  // nesting levels below an unknown key
  Key key_ = Key::kUnknown;
  std::array<bool, kKeyNames.size()> seen_{};
  std::string option_name_;
  std::string option_list_;
  bool option_list_is_empty_ = true;

  PolygonMesh mesh_;
  std::array<double, 3> coordinates_{};
  std::size_t coordinate_count_ = 0;
  std::unordered_map<std::string, std::uint32_t> group_index_;
  LabelSet* label_set_ = nullptr;  // the one that is being read
  std::string label_kind_;
  bool is_label_names_ = false;            // its names or else its numbers
  std::set<std::string> seen_labels_;      // such as "group" and "group.names"
  std::vector<std::string> unknown_keys_;  // only the first few
  std::uint64_t unknown_key_count_ = 0;
  std::uint32_t ticks_ = 0;
};

std::uint64_t Handler::line() const {
  // The parser has read one byte beyond the value that it reports.
  const char* const end = at_ == text_.data() ? at_ : at_ - 1;
  return 1 + static_cast<std::uint64_t>(std::count(text_.data(), end, '\n'));
}

void Handler::fail(Code code, const std::string& message) const {
  throw Error(code, Stage::kRead, message).at_line(line());
}

void Handler::fail_at(Code code, std::uint64_t element, const std::string& message) const {
  throw Error(code, Stage::kRead, message).at_line(line()).at_element(element);
}

void Handler::fail_value() const {
  if (stack_.empty()) {
    fail(root_ == Place::kOptions ? Code::kInvalidOption : Code::kInvalidMesh, "the document must be an object");
  }
  switch (stack_.back()) {
    case Place::kRoot:
    case Place::kMesh:
      if (key_ == Key::kOptions) fail(Code::kInvalidOption, "options must be an object");
      fail_shape(std::string(kKeyNames[static_cast<std::size_t>(key_)]) + " must be " + std::string(expected_of_key()));
    case Place::kVertices:
    case Place::kVertex:
      fail_at(Code::kInvalidMesh, vertex_count(),
              "vertex " + std::to_string(vertex_count()) + " must be an array of three numbers");
    case Place::kFaces:
    case Place::kFace:
      fail_at(Code::kInvalidMesh, face_count(),
              "face " + std::to_string(face_count()) + " must be an array of vertex numbers");
    case Place::kFaceGroups: fail_shape("face_groups must be an array of whole numbers");
    case Place::kLabels:
    case Place::kLabelSet:
    case Place::kLabelNames:
    case Place::kLabelFaces:
      fail_shape(R"(labels must be as {"group": {"names": ["wall", ...], "of_face": [0, ...]}, ...})");
    case Place::kOptions:
    case Place::kOptionList: break;
  }
  options_.add(option_name_, "a nested value", ValueKind::kObject);
  fail_shape("an option must be a single value");
}

std::string_view Handler::expected_of_key() const {
  return key_ == Key::kMesh || key_ == Key::kLabels ? "an object" : "an array";
}

// Checks for cancellation and updates the progress every few thousand events.
void Handler::tick() {
  constexpr std::uint32_t kTicks = 4096;
  if (++ticks_ % kTicks != 0) return;
  control_.progress(static_cast<double>(at_ - text_.data()) / static_cast<double>(text_.size()));
}

bool Handler::key(std::string& name) {
  tick();
  if (skipped_depth_ > 0) return true;
  if (stack_.back() == Place::kOptions) {
    option_name_ = name;
    return true;
  }
  if (stack_.back() == Place::kLabels || stack_.back() == Place::kLabelSet) return label_key(name);
  const auto* known = std::find(kKeyNames.begin(), kKeyNames.end(), name);
  key_ = static_cast<Key>(known - kKeyNames.begin());
  if (stack_.back() == Place::kMesh && key_ == Key::kMesh) key_ = Key::kUnknown;
  if (key_ == Key::kUnknown) {
    if (stack_.back() == Place::kRoot && find_option(name) != nullptr)
      throw Error(Code::kInvalidOption, Stage::kRead,
                  "the option " + name + " stands beside the mesh; it belongs into \"options\": {...}")
          .for_option(name);
    skip_key(name);
    return true;
  }
  if (seen_[static_cast<std::size_t>(key_)]) {
    fail_json("the key " + in_quotes(name) + " occurs twice, or both inside and outside of \"mesh\"");
  }
  seen_[static_cast<std::size_t>(key_)] = true;
  return true;
}

void Handler::skip_key(const std::string& name) {
  key_ = Key::kUnknown;
  ++unknown_key_count_;
  if (unknown_keys_.size() < kMaxNamedKeys) unknown_keys_.push_back(shortened(name));
}

/// Takes a key of `labels`, which is a kind of label, or one of the two parts of such a kind.
bool Handler::label_key(const std::string& name) {
  const bool is_kind = stack_.back() == Place::kLabels;
  if (is_kind) {
    label_set_ = name == "object"     ? &mesh_.labels.object
                 : name == "group"    ? &mesh_.labels.group
                 : name == "material" ? &mesh_.labels.material
                                      : nullptr;
    label_kind_ = name;
  }
  if (is_kind ? label_set_ == nullptr : name != "names" && name != "of_face") {
    skip_key(name);
    return true;
  }
  key_ = Key::kLabels;
  is_label_names_ = name == "names";
  if (!seen_labels_.insert(is_kind ? name : label_kind_ + "." + name).second)
    fail_json("the key " + in_quotes(name) + " of labels occurs twice");
  return true;
}

bool Handler::scalar(ValueKind kind, std::string_view text) {
  tick();
  if (skipped_depth_ > 0) return true;
  if (!stack_.empty()) {
    const Place place = stack_.back();
    if (place == Place::kOptions) {
      options_.add(option_name_, text, kind);
      return true;
    }
    if (place == Place::kOptionList && kind == ValueKind::kString) {
      add_list_item(text);
      return true;
    }
    if (place == Place::kLabelNames && kind == ValueKind::kString) {
      add_label_name(text);
      return true;
    }
    const bool has_keys =
        place == Place::kRoot || place == Place::kMesh || place == Place::kLabels || place == Place::kLabelSet;
    if (has_keys && key_ == Key::kUnknown) return true;
  }
  fail_value();
}

bool Handler::number(const Number& number) {
  if (skipped_depth_ == 0 && !stack_.empty()) {
    switch (stack_.back()) {
      case Place::kVertex:
        if (coordinate_count_ == 3) fail_value();
        coordinates_[coordinate_count_++] = number.value;
        return true;
      case Place::kFace: add_corner(number); return true;
      case Place::kFaceGroups: add_face_group(number); return true;
      case Place::kLabelFaces: add_label_face(number); return true;
      case Place::kOptionList: add_list_item(number.text()); return true;
      default: break;
    }
  }
  return scalar(ValueKind::kNumber, number.text());
}

bool Handler::start(bool is_object) {
  tick();
  if (stack_.size() + skipped_depth_ >= kMaxDepth) {
    fail_json("nested deeper than " + std::to_string(kMaxDepth) + " levels");
  }
  if (skipped_depth_ > 0) {
    ++skipped_depth_;
  } else if (stack_.empty()) {
    if (!is_object) fail_value();
    stack_.push_back(root_);
  } else {
    enter_child(is_object);
  }
  return true;
}

void Handler::enter_child(bool is_object) {
  switch (stack_.back()) {
    case Place::kRoot:
    case Place::kMesh: {
      if (key_ == Key::kUnknown) {
        skipped_depth_ = 1;
        return;
      }
      if (is_object != (key_ == Key::kMesh || key_ == Key::kOptions || key_ == Key::kLabels)) fail_value();
      constexpr std::array kPlaceOfKey{Place::kMesh,  Place::kOptions,    Place::kVertices,
                                       Place::kFaces, Place::kFaceGroups, Place::kLabels};
      stack_.push_back(kPlaceOfKey[static_cast<std::size_t>(key_)]);
      if (arrays_ == Arrays::kPlain) read_plain_array();
      return;
    }
    case Place::kLabels:
    case Place::kLabelSet: {
      const bool is_set = stack_.back() == Place::kLabels;
      if (key_ == Key::kUnknown) {
        skipped_depth_ = 1;
        return;
      }
      if (is_object != is_set) fail_value();
      stack_.push_back(is_set ? Place::kLabelSet : is_label_names_ ? Place::kLabelNames : Place::kLabelFaces);
      return;
    }
    case Place::kVertices:
      if (is_object) fail_value();
      open_vertex();
      return;
    case Place::kFaces:
      if (is_object) fail_value();
      open_face();
      return;
    case Place::kOptions:
      if (is_object) fail_value();
      option_list_.clear();
      option_list_is_empty_ = true;
      stack_.push_back(Place::kOptionList);
      return;
    case Place::kVertex:
    case Place::kFace:
    case Place::kFaceGroups:
    case Place::kLabelNames:
    case Place::kLabelFaces:
    case Place::kOptionList: fail_value();
  }
}

/// Reads an array without the parser. The parser stands after the opening bracket and is moved to the closing one, as
/// if the array were empty.
void Handler::read_plain_array() {
  const auto here = static_cast<std::size_t>(at_ - text_.data());
  PolygonMesh* const mesh = building_ == Building::kMesh ? &mesh_ : nullptr;
  if (stack_.back() == Place::kVertices) {
    at_ = text_.data() + read_plain_vertices(text_, here, limits_, control_, mesh);
  } else if (stack_.back() == Place::kFaces) {
    at_ = text_.data() + read_plain_faces(text_, here, limits_, control_, mesh);
  }
}

bool Handler::end() {
  if (skipped_depth_ > 0) {
    --skipped_depth_;
    return true;
  }
  if (stack_.back() == Place::kVertex) close_vertex();
  if (stack_.back() == Place::kFace) close_face();
  if (stack_.back() == Place::kOptionList) {
    options_.add(option_name_, option_list_is_empty_ ? "none" : option_list_, ValueKind::kList);
  }
  stack_.pop_back();
  return true;
}

void Handler::open_vertex() {
  if (vertex_count() >= limits_.max_vertices) {
    throw Error(Code::kMeshTooLarge, Stage::kRead, "more than " + std::to_string(limits_.max_vertices) + " vertices")
        .with_limit(limits_.max_vertices);
  }
  coordinate_count_ = 0;
  stack_.push_back(Place::kVertex);
}

void Handler::close_vertex() {
  if (coordinate_count_ != 3) fail_value();
  if (building_ == Building::kMesh) mesh_.positions.push_back({coordinates_[0], coordinates_[1], coordinates_[2]});
}

void Handler::open_face() {
  if (face_count() >= limits_.max_faces) {
    throw Error(Code::kMeshTooLarge, Stage::kRead, "more than " + std::to_string(limits_.max_faces) + " faces")
        .with_limit(limits_.max_faces);
  }
  stack_.push_back(Place::kFace);
}

void Handler::add_corner(const Number& read) {
  tick();
  if (read.value != std::floor(read.value)) fail_value();
  const Number number = read.as_integer();
  if (!number.is_integer || number.is_negative || number.magnitude > kMaxIndex) {
    fail_at(Code::kIndexOutOfRange, face_count(),
            "face " + std::to_string(face_count()) + " names vertex " + shortened(number.text()));
  }
  if (mesh_.corners.size() >= PolygonMesh::kMaxCorners) {
    throw Error(Code::kMeshTooLarge, Stage::kRead,
                "the faces have more than " + std::to_string(PolygonMesh::kMaxCorners) + " corners")
        .with_limit(PolygonMesh::kMaxCorners);
  }
  mesh_.corners.push_back(VertexId(static_cast<std::uint32_t>(number.magnitude)));
}

void Handler::close_face() {
  const std::size_t corners = mesh_.corners.size() - mesh_.face_begin.back();
  if (corners < 3) {
    fail_at(Code::kInvalidMesh, face_count(),
            "face " + std::to_string(face_count()) + " has " + std::to_string(corners) +
                " corners; a face must have at least 3");
  }
  if (building_ == Building::kNothing) return mesh_.corners.clear();
  mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
}

void Handler::add_face_group(const Number& read) {
  tick();
  const Number number = read.as_integer();
  if (!number.is_integer) fail_value();
  if (building_ == Building::kNothing) return;
  LabelSet& groups = mesh_.labels.group;
  if (groups.of_face.size() >= limits_.max_faces) fail_shape("face_groups has more entries than a mesh may have faces");
  std::string name = number.text();
  const auto [group, is_new] = group_index_.try_emplace(name, static_cast<std::uint32_t>(groups.names.size()));
  if (is_new) groups.names.push_back(std::move(name));
  groups.of_face.push_back(group->second);
}

void Handler::add_label_name(std::string_view text) {
  if (building_ == Building::kMesh) label_set_->names.emplace_back(text);
}

void Handler::add_label_face(const Number& read) {
  tick();
  const Number number = read.as_integer();
  if (!number.is_integer || number.is_negative || number.magnitude > kMaxIndex) fail_value();
  if (building_ == Building::kNothing) return;
  if (label_set_->of_face.size() >= limits_.max_faces)
    fail_shape("the labels have more entries than a mesh may have faces");
  label_set_->of_face.push_back(static_cast<std::uint32_t>(number.magnitude));
}

void Handler::add_list_item(std::string_view text) {
  if (!option_list_is_empty_) option_list_ += ',';
  option_list_ += text;
  option_list_is_empty_ = false;
}

bool Handler::parse_error(std::size_t, const std::string& token, const Json::exception& error) {
  constexpr int kNumberOverflow = 406;
  const bool is_overflow = error.id == kNumberOverflow;
  const std::string_view last(at_ == text_.data() ? at_ : at_ - 1, text_.data() + text_.size());
  const bool is_named = last.starts_with("NaN") || last.starts_with("Infinity");  // some programs write these
  if (skipped_depth_ == 0 && !stack_.empty() && (is_overflow || is_named)) {
    const Place place = stack_.back();
    if (place == Place::kVertex) {
      fail_at(Code::kNonfiniteCoordinate, vertex_count(),
              "vertex " + std::to_string(vertex_count()) + " has a coordinate that is not a finite number");
    }
    if (is_overflow && place == Place::kFace) fail_value();
    if (is_overflow && place == Place::kOptions) options_.add(option_name_, token, ValueKind::kNumber);
  }
  // The message uses the parser's text without its prefix "[json.exception....] ". That text quotes the input, which
  // may be long.
  constexpr std::size_t kLongest = 300;
  const std::string_view what = error.what();
  const std::size_t prefix = what.find("] ");
  const std::string words = shortened(prefix == std::string_view::npos ? what : what.substr(prefix + 2), kLongest);
  fail_json(words + " (byte " + std::to_string(static_cast<std::uint64_t>(at_ - text_.data())) + ")");
}

void Handler::check_indices() const {
  for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
    for (const VertexId v : mesh_.face(FaceId(f))) {
      if (v.value < mesh_.positions.size()) continue;
      throw Error(Code::kIndexOutOfRange, Stage::kRead,
                  "face " + std::to_string(f) + " names vertex " + std::to_string(v.value) + "; there are " +
                      std::to_string(vertex_count()) + ", counted from 0")
          .at_element(f);
    }
  }
}

void Handler::check_labels(std::string_view kind, const LabelSet& labels) const {
  const std::string name = "labels." + std::string(kind);
  if (labels.of_face.size() != face_count()) {
    fail_shape(name + ".of_face has " + std::to_string(labels.of_face.size()) + " entries for " +
               std::to_string(face_count()) + " faces");
  }
  for (std::size_t f = 0; f < face_count(); ++f) {
    const std::uint32_t label = labels.of_face[FaceId(f)];
    if (label < labels.names.size()) continue;
    throw Error(Code::kIndexOutOfRange, Stage::kRead,
                name + ".of_face has " + std::to_string(label) + " for face " + std::to_string(f) + "; there are " +
                    std::to_string(labels.names.size()) + " names, counted from 0")
        .at_element(f);
  }
}

/// Numbers labels anew, so that equal names have one number, and each name has a face.
void join_equal_names(LabelSet& labels) {
  std::unordered_map<std::string, std::uint32_t> known;
  std::vector<std::string> names;
  std::vector<std::uint32_t> number_of(labels.names.size(), UINT32_MAX);
  for (std::uint32_t& label : labels.of_face.items()) {
    std::uint32_t& number = number_of[label];
    if (number == UINT32_MAX) {
      std::string& name = labels.names[label];
      const auto [at, is_new] = known.try_emplace(name, static_cast<std::uint32_t>(names.size()));
      number = at->second;
      if (is_new) names.push_back(std::move(name));
    }
    label = number;
  }
  labels.names = std::move(names);
}

ReadResult Handler::take_mesh() {
  const auto has = [&](Key key) { return seen_[static_cast<std::size_t>(key)]; };
  if (!has(Key::kVertices)) fail_shape("the mesh has no \"vertices\"");
  if (!has(Key::kFaces)) fail_shape("the mesh has no \"faces\"");
  if (face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kRead, "the mesh has no face");
  if (has(Key::kFaceGroups) && seen_labels_.contains("group")) {
    fail_shape("face_groups and the groups of labels exclude each other");
  }
  if (has(Key::kFaceGroups) && mesh_.labels.group.of_face.size() != face_count()) {
    fail_shape("face_groups has " + std::to_string(mesh_.labels.group.of_face.size()) + " entries for " +
               std::to_string(face_count()) + " faces");
  }
  check_indices();
  FaceLabels& labels = mesh_.labels;
  for (const auto& [kind, set] : {std::pair("object", &labels.object), std::pair("group", &labels.group),
                                  std::pair("material", &labels.material)}) {
    if (!seen_labels_.contains(kind)) continue;
    check_labels(kind, *set);
    join_equal_names(*set);
  }

  ReadResult result;
  result.mesh = std::move(mesh_);
  if (unknown_key_count_ > 0) {
    Diagnostic dropped;
    dropped.code = DiagnosticCode::kAttributeDropped;
    dropped.count = unknown_key_count_;
    dropped.message = "unknown keys were skipped:";
    for (const std::string& name : unknown_keys_) dropped.message += " " + in_quotes(name);
    if (unknown_key_count_ > unknown_keys_.size()) dropped.message += " ...";
    result.diagnostics.push_back(std::move(dropped));
  }
  return result;
}

ReadResult read_document(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options,
                         Arrays arrays, Building building) {
  Handler handler(text, limits, control, options, Place::kRoot, arrays, building);
  handler.run();
  return building == Building::kMesh ? handler.take_mesh() : ReadResult();
}

ReadResult read_plain_first(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options,
                            Building building) {
  try {
    OptionReader plain_options = options;
    ReadResult result = read_document(text, limits, control, plain_options, Arrays::kPlain, building);
    options = std::move(plain_options);
    return result;
  } catch (const NotPlain&) {
  } catch (const Error&) {
    // Unless the reading was cancelled, read everything again: the parser has not seen the arrays and misjudges its
    // position.
    control.check();
  }
  return read_document(text, limits, control, options, Arrays::kByEvents, building);
}

bool is_of_mesh(Code code) {
  return code == Code::kInvalidMesh || code == Code::kIndexOutOfRange || code == Code::kNonfiniteCoordinate ||
         code == Code::kEmptyMesh || code == Code::kMeshTooLarge;
}

}  // namespace

ReadResult read_json(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options) {
  return read_plain_first(text, limits, control, options, Building::kMesh);
}

ReadResult read_json_by_events(std::string_view text, const ReadLimits& limits, RunControl& control,
                               OptionReader& options) {
  return read_document(text, limits, control, options, Arrays::kByEvents, Building::kMesh);
}

void check_json_text(std::string_view text, const ReadLimits& limits, RunControl& control, OptionReader& options) {
  try {
    read_plain_first(text, limits, control, options, Building::kNothing);
  } catch (const Error& error) {
    if (!is_of_mesh(error.code)) throw;
  }
}

void read_json_options(std::string_view text, RunControl& control, OptionReader& options) {
  Handler handler(text, ReadLimits{}, control, options, Place::kOptions, Arrays::kByEvents, Building::kMesh);
  handler.run();
}

}  // namespace remesh::api
