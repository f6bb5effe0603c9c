#include <map>
#include <optional>
#include <utility>

#include "core/io/common/label_collector.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/common/numbered_labels.h"
#include "core/io/common/text_tokens.h"
#include "core/io/medit/medit.h"

namespace remesh {
namespace {

/// A name in a comment: `# reference 12: NAME`.
void take_name(std::string_view comment, NumberedLabels::Names& names) {
  std::string_view rest = comment;
  if (next_token(rest) != "reference") return;
  const std::string_view number = next_token(rest);
  std::int64_t reference = 0;
  const auto [stop, status] = std::from_chars(number.data(), number.data() + number.size(), reference);
  if (status != std::errc() || std::string_view(stop, number.data() + number.size()) != ":") return;
  if (rest.starts_with(' ')) rest.remove_prefix(1);
  if (rest.size() <= kMaxNameLength) names.try_emplace(reference, rest);
}

class MeditReader {
 public:
  MeditReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), tokens_(content, '#'), builder_(limits, control) {}

  ReadResult read() {
    const std::string_view first = next();
    if (first != "MeshVersionFormatted") throw tokens_.expected("not Medit's format: MeshVersionFormatted", first);
    (void)tokens_.integer<int>("a version");
    for (std::string_view keyword = next(); !keyword.empty() && keyword != "End";) keyword = read_section(keyword);
    ReadResult result;
    result.mesh = builder_.take();
    result.mesh.labels.group = references_.take(names_);
    for (const auto& [keyword, count] : dropped_)
      record_dropped("records of " + keyword + " were dropped", count, result.diagnostics);
    record_padding(content_, result.diagnostics);
    return result;
  }

 private:
  /// Reads what follows a keyword.
  /// Output: the next keyword.
  std::string_view read_section(std::string_view keyword) {
    if (keyword == "Dimension") {
      if (tokens_.integer<int>("the dimension") != 3) throw error("the mesh must have 3 dimensions");
    } else if (keyword == "Vertices") {
      read_vertices();
    } else if (keyword == "Triangles") {
      read_faces(3);
    } else if (keyword == "Quadrilaterals") {
      read_faces(4);
    } else {
      return skip(keyword);
    }
    const std::string_view end = next();
    if (!end.empty() && !is_letter(end.front())) throw tokens_.expected("a keyword", end);
    return end;
  }

  void read_vertices() {
    if (vertices_) throw error("there is a second list of vertices");
    vertices_ = tokens_.integer<std::uint64_t>("the number of vertices");
    announce();
    for (std::uint64_t v = 0; v < *vertices_; ++v) {
      builder_.tick(tokens_.offset(), content_.size());
      const Vec3 position = tokens_.point();
      builder_.add_vertex(position, tokens_.place());
      (void)tokens_.integer<std::int64_t>("the reference of a vertex");
    }
  }

  void read_faces(int corners) {
    if (!vertices_) throw error("there are faces before Vertices");
    const std::uint64_t count = tokens_.integer<std::uint64_t>("the number of faces");
    // A file may claim any number of faces. The sum of such numbers ends at kMost, so that it cannot overflow.
    faces_ = count > kMost - faces_ ? kMost : faces_ + count;
    announce();
    for (std::uint64_t f = 0; f < count; ++f) {
      builder_.tick(tokens_.offset(), content_.size());
      builder_.begin_face(static_cast<std::uint64_t>(corners), tokens_.place());
      for (int i = 0; i < corners; ++i) {
        const auto vertex = tokens_.integer<std::int64_t>("the number of a vertex");
        if (vertex < 1) throw error("a face refers to vertex " + std::to_string(vertex) + ", but they count from 1");
        builder_.add_corner(vertex - 1, tokens_.place());
      }
      references_.add_face(tokens_.integer<std::int64_t>("the reference of a face"));
    }
  }

  void announce() {
    // The shortest record has four numbers of one digit.
    constexpr std::size_t kMinRecord = 8;
    const std::uint64_t room = content_.size() / kMinRecord;
    builder_.announce(*vertices_, faces_, room, room, tokens_.place());
  }

  /// Skips the numbers of a section that is not read.
  std::string_view skip(std::string_view keyword) {
    const std::string name(keyword.substr(0, 40));
    std::string_view token = next();
    if (!token.empty() && is_digit(token.front())) {
      std::uint64_t count = 0;
      std::from_chars(token.data(), token.data() + token.size(), count);
      if (count > 0 && (dropped_.size() < kMaxKinds || dropped_.contains(name))) dropped_[name] += count;
    }
    while (!token.empty() && !is_letter(token.front())) token = next();
    return token;
  }

  /// Takes the next token, and the names in the comments before it.
  std::string_view next() {
    for (;;) {
      std::string_view rest = tokens_.rest_of_line();
      if (!trim(rest).empty()) break;
      if (!tokens_.next_line()) return {};
      builder_.tick(tokens_.offset(), content_.size());
      if (!tokens_.comment().empty()) take_name(tokens_.comment(), names_);
    }
    return tokens_.next();
  }

  Error error(const std::string& message) const { return read_error(tokens_.place(), Code::kInvalidMesh, message); }

  static constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
  static constexpr std::size_t kMaxKinds = 32;

  std::string_view content_;
  TextTokens tokens_;
  MeshBuilder builder_;
  NumberedLabels references_;
  NumberedLabels::Names names_;
  std::map<std::string, std::uint64_t> dropped_;
  std::optional<std::uint64_t> vertices_;
  std::uint64_t faces_ = 0;
};

}  // namespace

ReadResult read_medit(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return MeditReader(content, limits, control).read();
}

}  // namespace remesh
