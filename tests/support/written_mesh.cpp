#include "tests/support/written_mesh.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace remesh::test {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

/// Splits text into words and lines.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  bool is_at_end() {
    skip_blanks();
    return text_.empty();
  }
  std::string_view word() {
    skip_blanks();
    if (text_.empty()) fail("the text ends early");
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n"), text_.size());
    const std::string_view word = text_.substr(0, end);
    text_.remove_prefix(end);
    return word;
  }
  std::string_view line() {
    const std::size_t end = std::min(text_.find('\n'), text_.size());
    const std::string_view line = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    return line;
  }
  void expect(std::string_view expected) {
    const std::string_view found = word();
    if (found != expected) fail("\"" + std::string(found) + "\" where " + std::string(expected) + " should be");
  }
  double number() {
    const std::string_view digits = word();
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
      fail("\"" + std::string(digits) + "\" is no finite number");
    return value;
  }
  std::uint32_t index() {
    const std::string_view digits = word();
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size())
      fail("\"" + std::string(digits) + "\" is no index");
    return value;
  }
  Vec3 point() {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = number();
    return p;
  }

 private:
  void skip_blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(" \t\r\n"), text_.size())); }

  std::string_view text_;
};

WrittenMesh read_obj(std::string_view text) {
  WrittenMesh mesh;
  Words lines(text);
  while (!lines.is_at_end()) {
    const std::string_view line = lines.line();
    Words words(line);
    if (line.starts_with("v ")) {
      words.expect("v");
      mesh.positions.push_back(words.point());
    } else if (line.starts_with("f ")) {
      words.expect("f");
      auto& face = mesh.faces.emplace_back();
      for (std::uint32_t& v : face) v = words.index() - 1;
      if (!words.is_at_end()) fail("a face with more than three corners");
    }
  }
  return mesh;
}

WrittenMesh read_off(std::string_view text) {
  std::string plain;
  Words lines(text);
  while (!lines.is_at_end()) {
    const std::string_view line = lines.line();
    plain.append(line.substr(0, line.find('#'))).append("\n");
  }
  WrittenMesh mesh;
  Words words(plain);
  words.expect("OFF");
  const std::uint32_t vertices = words.index(), faces = words.index();
  words.index();
  for (std::uint32_t v = 0; v < vertices; ++v) mesh.positions.push_back(words.point());
  for (std::uint32_t f = 0; f < faces; ++f) {
    words.expect("3");
    auto& face = mesh.faces.emplace_back();
    for (std::uint32_t& v : face) v = words.index();
  }
  if (!words.is_at_end()) fail("something stands behind the last face");
  return mesh;
}

template <class T>
T take(std::string_view& bytes) {
  T value;
  if (bytes.size() < sizeof value) fail("the bytes end early");
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

void add_corners(WrittenMesh& mesh, const std::array<Vec3, 3>& corners) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : corners) {
    if (!is_finite(p)) fail("a coordinate is not finite");
    mesh.positions.push_back(p);
  }
  mesh.faces.push_back({first, first + 1, first + 2});
}

WrittenMesh read_stl(std::string_view bytes) {
  WrittenMesh mesh;
  mesh.has_own_vertices = false;
  mesh.has_floats = true;
  if (bytes.size() < 84) fail("too short for STL");
  bytes.remove_prefix(80);
  const auto count = take<std::uint32_t>(bytes);
  if (bytes.size() != std::size_t{50} * count) fail("the length of the STL file is not that of its triangles");
  for (std::uint32_t f = 0; f < count; ++f) {
    for (int i = 0; i < 3; ++i)
      if (!std::isfinite(take<float>(bytes))) fail("a normal is not finite");
    std::array<Vec3, 3> corners;
    for (Vec3& p : corners)
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(take<float>(bytes));
    add_corners(mesh, corners);
    take<std::uint16_t>(bytes);
  }
  return mesh;
}

WrittenMesh read_stl_text(std::string_view text) {
  WrittenMesh mesh;
  mesh.has_own_vertices = false;
  Words words(text);
  while (!words.is_at_end()) {
    words.expect("solid");
    const std::string name(words.line());
    for (;;) {
      const std::string_view word = words.word();
      if (word == "endsolid") break;
      if (word != "facet") fail("\"" + std::string(word) + "\" where a facet should be");
      words.expect("normal");
      words.point();
      words.expect("outer");
      words.expect("loop");
      std::array<Vec3, 3> corners;
      for (Vec3& p : corners) {
        words.expect("vertex");
        p = words.point();
      }
      add_corners(mesh, corners);
      mesh.solid_of.push_back(name.empty() ? name : name.substr(1));
      words.expect("endloop");
      words.expect("endfacet");
    }
    if (words.line() != name) fail("a solid ends by another name than it begins");
  }
  return mesh;
}

/// Reads PLY in the form in which it is written here: least significant byte first, vertices of three doubles or
/// floats, and lists with a byte for the count and 32-bit indices.
WrittenMesh read_ply(std::string_view bytes) {
  WrittenMesh mesh;
  std::size_t vertices = 0, faces = 0, more_of_face = 0;
  bool is_of_face = false;
  for (;;) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) fail("the header does not end");
    const std::string line(bytes.substr(0, end));
    bytes.remove_prefix(end + 1);
    Words words(line);
    if (line == "end_header") break;
    if (line.starts_with("element vertex ")) {
      words.word(), words.word();
      vertices = words.index();
    } else if (line.starts_with("element face ")) {
      words.word(), words.word();
      faces = words.index();
      is_of_face = true;
    } else if (line.starts_with("property float")) {
      mesh.has_floats = true;
    } else if (line.starts_with("property int ") && is_of_face) {
      more_of_face += 4;
    } else if (line.starts_with("format ") && line != "format binary_little_endian 1.0") {
      fail("a PLY format that is not read here");
    }
  }
  const auto coordinate = [&] {
    return mesh.has_floats ? static_cast<double>(take<float>(bytes)) : take<double>(bytes);
  };
  for (std::size_t v = 0; v < vertices; ++v) {
    Vec3& p = mesh.positions.emplace_back();
    for (int axis = 0; axis < 3; ++axis) p[axis] = coordinate();
    if (!is_finite(p)) fail("a coordinate is not finite");
  }
  for (std::size_t f = 0; f < faces; ++f) {
    if (take<std::uint8_t>(bytes) != 3) fail("a face that is no triangle");
    auto& face = mesh.faces.emplace_back();
    for (std::uint32_t& v : face) v = take<std::uint32_t>(bytes);
    if (bytes.size() < more_of_face) fail("the bytes end early");
    bytes.remove_prefix(more_of_face);
  }
  if (!bytes.empty()) fail("something stands behind the last face");
  return mesh;
}

/// Reads PLY as text, with x, y and z as the only properties of vertices.
WrittenMesh read_ply_text(std::string_view text) {
  WrittenMesh mesh;
  std::uint32_t vertices = 0, faces = 0, more_of_face = 0;
  Words lines(text);
  for (std::string_view line = lines.line(); line != "end_header"; line = lines.line()) {
    Words words(line);
    if (line.starts_with("format ") && line != "format ascii 1.0") fail("a PLY format that is not read here");
    if (line.starts_with("property int ")) ++more_of_face;
    if (!line.starts_with("element ")) continue;
    words.expect("element");
    const bool are_vertices = words.word() == "vertex";
    (are_vertices ? vertices : faces) = words.index();
  }
  for (std::uint32_t v = 0; v < vertices; ++v) mesh.positions.push_back(lines.point());
  for (std::uint32_t f = 0; f < faces; ++f) {
    lines.expect("3");
    auto& face = mesh.faces.emplace_back();
    for (std::uint32_t& v : face) v = lines.index();
    for (std::uint32_t i = 0; i < more_of_face; ++i) lines.index();
  }
  if (!lines.is_at_end()) fail("something stands behind the last face");
  return mesh;
}

/// Reads Medit's format of version 2 without comments between the records.
WrittenMesh read_medit(std::string_view text) {
  WrittenMesh mesh;
  const std::size_t begin = text.find("\nVertices\n");
  if (begin == std::string_view::npos || !text.starts_with("MeshVersionFormatted 2\nDimension 3\n"))
    fail("a Medit file not read here");
  Words words(text.substr(begin));
  words.expect("Vertices");
  const std::uint32_t vertices = words.index();
  for (std::uint32_t v = 0; v < vertices; ++v) {
    mesh.positions.push_back(words.point());
    words.expect("0");
  }
  words.expect("Triangles");
  const std::uint32_t faces = words.index();
  for (std::uint32_t f = 0; f < faces; ++f) {
    auto& face = mesh.faces.emplace_back();
    for (std::uint32_t& v : face) v = words.index() - 1;
    if (words.index() == 0) fail("a reference is 0");
  }
  words.expect("End");
  return mesh;
}

/// Reads TetGen's format of surfaces: nodes and facets numbered from 1, with markers.
WrittenMesh read_smesh(std::string_view text) {
  std::string plain;
  for (Words lines(text); !lines.is_at_end();) {
    const std::string_view line = lines.line();
    if (!line.starts_with('#')) plain.append(line).append("\n");
  }
  WrittenMesh mesh;
  Words words(plain);
  const std::uint32_t vertices = words.index();
  for (const char* number : {"3", "0", "0"}) words.expect(number);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (words.index() != v + 1) fail("nodes are not numbered from 1");
    mesh.positions.push_back(words.point());
  }
  const std::uint32_t faces = words.index();
  words.expect("1");
  for (std::uint32_t f = 0; f < faces; ++f) {
    words.expect("3");
    auto& face = mesh.faces.emplace_back();
    for (std::uint32_t& v : face) v = words.index() - 1;
    if (words.index() == 0) fail("a marker is 0");
  }
  for (const int numbers : {0, 2}) {  // behind the points of holes, and those of regions
    for (std::uint32_t points = words.index(); points > 0; --points) {
      words.index(), words.point();
      for (int i = 0; i < numbers; ++i) words.number();
    }
  }
  if (!words.is_at_end()) fail("something stands behind the regions");
  return mesh;
}

/// Reads version 4.1 of Gmsh's format as text, with nodes numbered from 1 in one block. The faces come in the order of
/// their numbers.
WrittenMesh read_new_msh(std::string_view text) {
  WrittenMesh mesh;
  Words words(text.substr(text.find("\n$Nodes\n")));
  words.expect("$Nodes");
  words.expect("1");
  const std::uint32_t vertices = words.index();
  for (int i = 0; i < 6; ++i) words.index();
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (words.index() != v + 1) fail("nodes are not numbered from 1");
  for (std::uint32_t v = 0; v < vertices; ++v) mesh.positions.push_back(words.point());
  words.expect("$EndNodes");
  words.expect("$Elements");
  const std::uint32_t blocks = words.index();
  mesh.faces.resize(words.index());
  words.index(), words.index();
  for (std::uint32_t b = 0; b < blocks; ++b) {
    words.expect("2");
    words.index();
    words.expect("2");
    for (std::uint32_t left = words.index(); left > 0; --left) {
      const std::uint32_t number = words.index();
      if (number < 1 || number > mesh.faces.size()) fail("elements are not numbered from 1");
      for (std::uint32_t& v : mesh.faces[number - 1]) v = words.index() - 1;
    }
  }
  words.expect("$EndElements");
  return mesh;
}

/// Reads Gmsh's format as text.
WrittenMesh read_msh(std::string_view text) {
  if (text.starts_with("$MeshFormat\n4.1 0 8\n")) return read_new_msh(text);
  WrittenMesh mesh;
  const std::size_t nodes = text.find("\n$Nodes\n");
  if (nodes == std::string_view::npos || !text.starts_with("$MeshFormat\n2.2 0 8\n")) fail("an MSH file not read here");
  Words words(text.substr(nodes));
  words.expect("$Nodes");
  const std::uint32_t vertices = words.index();
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (words.index() != v + 1) fail("nodes are not numbered from 1");
    mesh.positions.push_back(words.point());
  }
  words.expect("$EndNodes");
  words.expect("$Elements");
  const std::uint32_t faces = words.index();
  for (std::uint32_t f = 0; f < faces; ++f) {
    words.index();
    words.expect("2");
    words.expect("2");
    words.index(), words.index();
    auto& face = mesh.faces.emplace_back();
    for (std::uint32_t& v : face) v = words.index() - 1;
  }
  words.expect("$EndElements");
  return mesh;
}

std::string from_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int known = 0;
  for (const char c : text) {
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    known += 6;
    if (known < 8) continue;
    known -= 8;
    bytes += static_cast<char>(bits >> known & 255);
  }
  return bytes;
}

/// Returns the numbers of a data array of VTU, which come after their length.
std::string vtu_array(std::string_view text, std::string_view after) {
  const std::size_t begin = text.find('>', text.find("<DataArray", text.find(after))) + 1;
  const std::string bytes = from_base64(text.substr(begin, text.find('<', begin) - begin));
  std::string_view rest = bytes;
  if (take<std::uint64_t>(rest) != rest.size()) fail("a data array has another length than it tells");
  return std::string(rest);
}

WrittenMesh read_vtu(std::string_view text) {
  WrittenMesh mesh;
  const std::string points = vtu_array(text, "<Points>"), corners = vtu_array(text, "<Cells>");
  for (std::string_view rest = points; !rest.empty();) {
    Vec3& p = mesh.positions.emplace_back();
    for (int axis = 0; axis < 3; ++axis) p[axis] = take<double>(rest);
    if (!is_finite(p)) fail("a coordinate is not finite");
  }
  for (std::string_view rest = corners; !rest.empty();) {
    auto& face = mesh.faces.emplace_back();
    for (std::uint32_t& v : face) v = static_cast<std::uint32_t>(take<std::int64_t>(rest));
  }
  return mesh;
}

void expect_finite(const nlohmann::json& value) {
  if (value.is_number() && !std::isfinite(value.get<double>())) fail("a number in the JSON is not finite");
  if (value.is_structured())
    for (const auto& item : value) expect_finite(item);
}

nlohmann::json parse(const std::string& text) {
  try {
    nlohmann::json document = nlohmann::json::parse(text);
    expect_finite(document);
    return document;
  } catch (const nlohmann::json::exception& error) {
    fail(std::string("the JSON cannot be read: ") + error.what());
  }
}

/// Reads binary glTF whose primitives share the vertices of accessor 0 and have indices of 32 bits.
WrittenMesh read_glb(std::string_view bytes) {
  WrittenMesh mesh;
  mesh.has_floats = true;
  if (!bytes.starts_with("glTF") || bytes.size() % 4 != 0) fail("a glTF file not read here");
  std::string_view head = bytes.substr(4, 16);
  if (take<std::uint32_t>(head) != 2 || take<std::uint32_t>(head) != bytes.size()) fail("a wrong head of glTF");
  const auto json_size = take<std::uint32_t>(head);
  const nlohmann::json document = parse(std::string(bytes.substr(20, json_size)));
  const std::string_view data = bytes.substr(28 + json_size);
  const auto numbers = [&](const nlohmann::json& accessor) {
    const nlohmann::json& view = document.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    return data.substr(view.value("byteOffset", 0u) + accessor.value("byteOffset", 0u));
  };
  const nlohmann::json& points = document.at("accessors").at(0);
  std::string_view rest = numbers(points);
  for (std::size_t v = 0; v < points.at("count").get<std::size_t>(); ++v) {
    Vec3& p = mesh.positions.emplace_back();
    for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(take<float>(rest));
  }
  for (const nlohmann::json& primitive : document.at("meshes").at(0).at("primitives")) {
    const nlohmann::json& corners = document.at("accessors").at(primitive.at("indices").get<std::size_t>());
    rest = numbers(corners);
    for (std::size_t i = 0; i < corners.at("count").get<std::size_t>(); i += 3) {
      auto& face = mesh.faces.emplace_back();
      for (std::uint32_t& v : face) v = take<std::uint32_t>(rest);
    }
  }
  return mesh;
}

WrittenMesh read_json(const std::string& text) {
  const nlohmann::json document = parse(text);
  WrittenMesh mesh;
  try {
    for (const auto& p : document.at("mesh").at("vertices")) mesh.positions.push_back({p.at(0), p.at(1), p.at(2)});
    for (const auto& face : document.at("mesh").at("faces")) mesh.faces.push_back({face.at(0), face.at(1), face.at(2)});
  } catch (const nlohmann::json::exception& error) {
    fail(std::string("the JSON has no mesh: ") + error.what());
  }
  return mesh;
}

}  // namespace

void expect_finite_json(const std::string& text) { parse(text); }

WrittenMesh read_written(Format format, const std::string& bytes) {
  WrittenMesh mesh;
  switch (format) {
    case Format::kObj: mesh = read_obj(bytes); break;
    case Format::kOff: mesh = read_off(bytes); break;
    case Format::kStl: mesh = read_stl(bytes); break;
    case Format::kStlAscii: mesh = read_stl_text(bytes); break;
    case Format::kPly: mesh = read_ply(bytes); break;
    case Format::kJson: mesh = read_json(bytes); break;
    case Format::kMsh: mesh = read_msh(bytes); break;
    case Format::kVtu: mesh = read_vtu(bytes); break;
    case Format::kMesh: mesh = read_medit(bytes); break;
    case Format::kSmesh: mesh = read_smesh(bytes); break;
    case Format::kPlyAscii: mesh = read_ply_text(bytes); break;
    case Format::kGlb: mesh = read_glb(bytes); break;
    case Format::kThreemf:
    case Format::kInp:
    case Format::kBdf: fail("this format is not written");
  }
  for (const auto& face : mesh.faces)
    for (const std::uint32_t v : face)
      if (v >= mesh.positions.size()) fail("a face has a corner that is no vertex");
  return mesh;
}

}  // namespace remesh::test
