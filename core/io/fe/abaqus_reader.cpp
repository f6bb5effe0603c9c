#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>

#include "core/io/common/label_collector.h"
#include "core/io/common/numbered_labels.h"
#include "core/io/common/text_lines.h"
#include "core/io/fe/fe.h"
#include "core/io/fe/fe_surface.h"

namespace remesh {
namespace {

std::string lower_text(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), to_lower);
  return lower;
}

/// Removes what stands before the next comma from a line, and returns it without blanks around it.
std::string_view take_field(std::string_view& rest) {
  const std::size_t comma = rest.find(',');
  const std::string_view field = trim(rest.substr(0, comma));
  rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  return field;
}

struct FaceType {
  std::size_t nodes = 0;  ///< 0: the element is no face
  std::size_t corners = 0;
};

/// Finds the number of nodes of an element by its type in lower case: the digit behind the letters of its family.
FaceType abaqus_face_type(std::string_view type) {
  constexpr std::array<std::string_view, 9> kFamilies{"s", "ds", "stri", "m3d", "r3d", "sfm3d", "f3d", "cps", "cpe"};
  for (const std::string_view family : kFamilies) {
    if (!type.starts_with(family) || type.size() == family.size()) continue;
    switch (type[family.size()]) {
      case '3': return {3, 3};
      case '6': return {6, 3};
      case '4': return {4, 4};
      case '8': return {8, 4};
      case '9': return {9, 4};
      default: break;
    }
  }
  return {};
}

class AbaqusReader {
 public:
  AbaqusReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : lines_(content), surface_(content, limits, control) {}

  ReadResult read() {
    while (lines_.next()) {
      surface_.tick(lines_.offset());
      const std::string_view line = trim(lines_.line());
      if (line.empty() || line.starts_with("**")) continue;
      lines_.check_is_text();
      if (keyword_.ends_with(',')) {
        // A line of keywords that ends with a comma goes on.
        if (keyword_.size() > 4 * kMaxNameLength) throw error("a line of keywords that does not end");
        keyword_.append(line);
      } else if (line.starts_with('*')) {
        keyword_.assign(line.substr(1));
      } else {
        read_data(line);
        continue;
      }
      if (!keyword_.ends_with(',')) begin_section(keyword_);
    }
    if (!values_.empty()) throw error("the text ends within an element");
    LabelSet groups = take_groups();
    ReadResult result = surface_.take();
    result.mesh.labels.group = std::move(groups);
    return result;
  }

 private:
  enum class Section { kOther, kNodes, kElements, kSet, kSetOfRanges, kInstance };

  void begin_section(std::string_view rest) {
    if (!values_.empty()) throw error("an element with fewer nodes than its type has");
    const std::string keyword = lower_text(take_field(rest));
    section_ = Section::kOther;
    is_continued_ = false;
    std::string elset, type, part;
    bool is_generated = false, has_system = false;
    while (!rest.empty()) {
      std::string_view value = take_field(rest);
      const std::size_t equals = value.find('=');
      const std::string key = lower_text(trim(value.substr(0, equals)));
      value = equals == std::string_view::npos ? std::string_view() : trim(value.substr(equals + 1));
      if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
      if (value.size() > kMaxNameLength)
        throw error("a name of more than " + std::to_string(kMaxNameLength) + " bytes");
      if (key == "elset") elset = value;
      if (key == "type") type = lower_text(value);
      if (key == "part") part = value;
      is_generated = is_generated || key == "generate";
      has_system = has_system || (key == "system" && lower_text(value) != "r");
    }
    if (keyword == "node") {
      if (has_system) throw error("nodes in another system of coordinates are not read");
      section_ = Section::kNodes;
    } else if (keyword == "element") {
      section_ = Section::kElements;
      type_ = abaqus_face_type(type);
      kind_ = type.empty() ? "without a type" : type;
      set_ = elset.empty() ? 0 : number_of(elset);
    } else if (keyword == "elset") {
      section_ = is_generated ? Section::kSetOfRanges : Section::kSet;
      set_ = number_of(elset);
    } else if (keyword == "part") {
      part_ = ++parts_;
    } else if (keyword == "assembly" || keyword == "end part") {
      part_ = 0;
    } else if (keyword == "instance") {
      section_ = Section::kInstance;
      if (!placed_.insert(lower_text(part)).second) throw error("a part that is placed twice is not read");
    } else if (keyword == "include" || keyword == "system" || keyword == "ngen" || keyword == "nfill" ||
               keyword == "nmap" || keyword == "ncopy" || keyword == "elgen" || keyword == "elcopy") {
      throw error("*" + keyword + " is not read; write the model with all nodes and elements in one file");
    }
  }

  void read_data(std::string_view line) {
    switch (section_) {
      case Section::kNodes: return read_node(line);
      case Section::kElements: return read_element(line);
      case Section::kSet: return read_set(line);
      case Section::kSetOfRanges: return read_range(line);
      case Section::kInstance: throw error("a part that is moved or turned is not read");
      case Section::kOther: break;
    }
  }

  void read_node(std::string_view line) {
    const std::uint64_t tag = tag_of(take_field(line), "the number of a node");
    Vec3 position;
    for (int axis = 0; axis < 3; ++axis) position[axis] = parse_fortran_coordinate(take_field(line), lines_.number());
    surface_.add_node(tag, position, lines_.number());
  }

  void read_element(std::string_view line) {
    if (type_.nodes == 0) {
      // A line that ends with a comma goes on.
      if (!is_continued_) surface_.drop(kind_);
      is_continued_ = line.ends_with(',');
      return;
    }
    while (!line.empty()) {
      const std::string_view field = take_field(line);
      if (field.empty() && line.empty()) break;
      if (values_.size() > type_.nodes) throw error("an element with more nodes than its type has");
      values_.push_back(tag_of(field, "the number of a node"));
    }
    if (values_.size() <= type_.nodes) return;
    surface_.add_face(values_[0], std::span(values_).subspan(1, type_.corners), lines_.number());
    own_set_.push_back(set_);
    values_.clear();
  }

  void read_range(std::string_view line) {
    const std::uint64_t first = tag_of(take_field(line), "the first element of a set");
    const std::uint64_t last = tag_of(take_field(line), "the last element of a set");
    const std::string_view step = take_field(line);
    ranges_.push_back({first, last, step.empty() ? 1 : parse_tag(step, "a step", lines_.number()), set_});
  }

  void read_set(std::string_view line) {
    while (!line.empty()) {
      const std::string_view field = take_field(line);
      // A set may have the names of other sets.
      if (field.empty() || !is_digit(field.front())) continue;
      const std::uint64_t tag = tag_of(field, "the number of an element");
      ranges_.push_back({tag, tag, 1, set_});
    }
  }

  /// The group of each face: the first set that has it, or else the set of its element.
  LabelSet take_groups() {
    const NodeTags& faces = surface_.sorted_faces();
    std::vector<std::uint32_t> set_of(faces.size(), 0);
    // A face may be in several sets, but in so many only if somebody wants to keep a core busy.
    std::uint64_t visits = 16 * std::uint64_t{faces.size()} + ranges_.size();
    for (const Range& range : ranges_) {
      for (std::size_t i = faces.lower_bound(range.first); i < faces.size(); ++i) {
        surface_.tick(lines_.offset());
        const auto [tag, face] = faces.at(i);
        if (tag > range.last) break;
        if (visits-- == 0) throw error("the sets overlap more than 16 times");
        if ((tag - range.first) % range.step == 0 && set_of[face] == 0) set_of[face] = range.set;
      }
    }
    NumberedLabels labels;
    for (std::size_t f = 0; f < set_of.size(); ++f) labels.add_face(set_of[f] > 0 ? set_of[f] : own_set_[f]);
    NumberedLabels::Names names{{0, ""}};
    for (const auto& [name, number] : number_of_) names.emplace(number, name);
    if (std::all_of(own_set_.begin(), own_set_.end(), [](std::uint32_t set) { return set == 0; }) &&
        std::all_of(set_of.begin(), set_of.end(), [](std::uint32_t set) { return set == 0; }))
      names.clear();
    return labels.take(names);
  }

  std::uint32_t number_of(const std::string& set) {
    return number_of_.try_emplace(set, static_cast<std::uint32_t>(number_of_.size() + 1)).first->second;
  }

  /// A number within its part. Parts count their nodes and elements on their own.
  std::uint64_t tag_of(std::string_view field, const char* what) const {
    constexpr int kBits = 32;
    return parse_tag(field, what, lines_.number()) | std::uint64_t{part_} << kBits;
  }

  Error error(const std::string& message) const {
    return read_error(Place::line(lines_.number()), Code::kInvalidMesh, message);
  }

  struct Range {
    std::uint64_t first, last, step;
    std::uint32_t set;
  };

  TextLines lines_;
  FeSurface surface_;
  Section section_ = Section::kOther;
  FaceType type_;
  std::string kind_, keyword_;
  std::uint32_t set_ = 0, part_ = 0, parts_ = 0;
  bool is_continued_ = false;           ///< the last line of an element that is no face ended with a comma
  std::vector<std::uint64_t> values_;   ///< of the element that is being read
  std::vector<std::uint32_t> own_set_;  ///< by face
  std::vector<Range> ranges_;
  std::map<std::string, std::uint32_t> number_of_;  ///< by the name of a set, from 1
  std::set<std::string> placed_;
};

}  // namespace

bool is_abaqus(std::string_view text) {
  constexpr std::string_view kNode = "*node";
  return text.starts_with('*') && std::search(text.begin(), text.end(), kNode.begin(), kNode.end(),
                                              [](char c, char lower) { return to_lower(c) == lower; }) != text.end();
}

ReadResult read_abaqus(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return AbaqusReader(content, limits, control).read();
}

}  // namespace remesh
