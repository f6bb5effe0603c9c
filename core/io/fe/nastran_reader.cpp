#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "core/io/common/numbered_labels.h"
#include "core/io/common/text_lines.h"
#include "core/io/fe/fe.h"
#include "core/io/fe/fe_surface.h"

namespace remesh {
namespace {

/// The cards of faces, with their numbers of corners.
constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kFaceCards{
    {{"ctria3", 3}, {"ctriar", 3}, {"ctria6", 3}, {"cquad4", 4}, {"cquadr", 4}, {"cquad8", 4}, {"cquad", 4}}};

/// A record: its name in lower case, and the fields that faces and grid points have. Others are left out.
struct Card {
  static constexpr std::size_t kFields = 6;

  std::string name;
  std::array<std::string, kFields> fields;
  std::uint64_t line = 0;
};

class NastranReader {
 public:
  NastranReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : lines_(content), surface_(content, limits, control) {}

  ReadResult read() {
    while (lines_.next()) {
      surface_.tick(lines_.offset());
      std::string_view line = lines_.line();
      line = line.substr(0, line.find('$'));
      if (trim(line).empty()) continue;
      lines_.check_is_text();
      if (!is_continuation(line)) {
        finish_card();
        if (is_at_end_) break;
      }
      take_line(line);
    }
    finish_card();
    ReadResult result;
    (void)surface_.sorted_faces();
    result = surface_.take();
    result.mesh.labels.group = properties_.take({});
    return result;
  }

 private:
  static constexpr std::size_t kNarrow = 8, kWide = 16;

  static bool is_continuation(std::string_view line) {
    return line.front() == '+' || line.front() == '*' || line.front() == ',' ||
           (line.size() > kNarrow && trim(line.substr(0, kNarrow)).empty());
  }

  /// Takes the fields of a line: behind the name of a card, or behind the mark of a continuation.
  void take_line(std::string_view line) {
    const bool is_free = line.find(',') != std::string_view::npos;
    const std::size_t end_of_first = is_free ? line.find(',') : std::min(kNarrow, line.size());
    std::string_view first = trim(line.substr(0, end_of_first));
    const bool is_first = !is_continuation(line);
    const bool is_wide = first.find('*') != std::string_view::npos;
    if (is_first) {
      first = first.substr(0, std::min(first.find('*'), first.find(' ')));
      card_.name.assign(first.substr(0, 2 * kNarrow));
      std::transform(card_.name.begin(), card_.name.end(), card_.name.begin(), to_lower);
      card_.line = lines_.number();
      next_ = 0;
    } else if (card_.name.empty()) {
      return;
    }
    line.remove_prefix(is_free ? end_of_first + 1 : end_of_first);
    const std::size_t count = is_wide ? 4 : 8, width = is_wide ? kWide : kNarrow;
    for (std::size_t i = 0; i < count && next_ < Card::kFields; ++i, ++next_) {
      const std::size_t end = is_free ? std::min(line.find(','), line.size()) : std::min(width, line.size());
      card_.fields[next_].assign(trim(line.substr(0, end)));
      line.remove_prefix(std::min(is_free ? end + 1 : end, line.size()));
    }
  }

  void finish_card() {
    if (card_.name == "enddata") is_at_end_ = true;
    if (card_.name == "include") throw error("other files are not read; write the model into one file");
    if (card_.name == "grid") add_grid();
    const auto* face = std::find_if(kFaceCards.begin(), kFaceCards.end(),
                                    [&](const auto& known) { return known.first == card_.name; });
    if (face != kFaceCards.end()) {
      add_face(face->second);
    } else if (card_.name.starts_with('c') && !card_.name.starts_with("cord") && !card_.fields[0].empty() &&
               is_digit(card_.fields[0].front())) {
      surface_.drop(card_.name);
    }
    card_ = {};
  }

  void add_grid() {
    const std::string& system = card_.fields[1];
    if (!system.empty() && system != "0") throw error("grid points in another system of coordinates are not read");
    Vec3 position;
    for (int axis = 0; axis < 3; ++axis)
      position[axis] = parse_fortran_coordinate(card_.fields[static_cast<std::size_t>(axis) + 2], card_.line);
    surface_.add_node(parse_tag(card_.fields[0], "the number of a grid point", card_.line), position, card_.line);
  }

  void add_face(std::size_t corners) {
    std::array<std::uint64_t, 4> tags{};
    for (std::size_t i = 0; i < corners; ++i)
      tags[i] = parse_tag(card_.fields[i + 2], "the number of a grid point", card_.line);
    const std::uint64_t element = parse_tag(card_.fields[0], "the number of an element", card_.line);
    // Without a property, its number is that of the element.
    const std::string& property = card_.fields[1];
    properties_.add_face(static_cast<std::int64_t>(
        property.empty() ? element : parse_tag(property, "the number of a property", card_.line)));
    surface_.add_face(element, std::span(tags).first(corners), card_.line);
  }

  Error error(const std::string& message) const {
    return read_error(Place::line(card_.line), Code::kInvalidMesh, message);
  }

  TextLines lines_;
  FeSurface surface_;
  NumberedLabels properties_;
  Card card_;
  std::size_t next_ = 0;
  bool is_at_end_ = false;
};

}  // namespace

bool is_nastran(std::string_view text) {
  constexpr std::size_t kHead = 65536;
  std::string_view rest = text.substr(0, kHead);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (equals_ignoring_case(trim(line.substr(0, line.find('$'))), "begin bulk")) return true;
    if (!equals_ignoring_case(line.substr(0, 4), "grid") || line.size() < 6) continue;
    if (line[4] == ',' || line[4] == '*' || is_blank(line[4])) return true;
  }
  return false;
}

ReadResult read_nastran(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return NastranReader(content, limits, control).read();
}

}  // namespace remesh
