#include "tests/support/plain_readers.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>

namespace remesh::test {
namespace {

using Corners = std::array<Vec3, 3>;

/// A mesh of vertices and faces, from which triangles are made.
struct Indexed {
  std::vector<Vec3> points;
  std::vector<std::array<std::size_t, 3>> faces;

  PlainMesh triangles() const {
    PlainMesh mesh;
    for (const auto& face : faces)
      mesh.triangles.push_back({points.at(face[0]), points.at(face[1]), points.at(face[2])});
    return mesh;
  }
};

/// Splits a text into words. Numbers are read by strtod.
class Words {
 public:
  explicit Words(const std::string& text) : in_(text) {}
  bool next(std::string& word) { return static_cast<bool>(in_ >> word); }
  std::string word() {
    std::string word;
    EXPECT_TRUE(next(word));
    return word;
  }
  double number() { return std::strtod(word().c_str(), nullptr); }
  std::size_t index() { return static_cast<std::size_t>(std::strtoull(word().c_str(), nullptr, 10)); }
  Vec3 point() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  void skip_line() {
    std::string line;
    std::getline(in_, line);
  }
  std::string rest_of_line() {
    std::string line;
    std::getline(in_, line);
    const std::size_t begin = line.find_first_not_of(' ');
    return begin == std::string::npos ? "" : line.substr(begin);
  }

 private:
  std::istringstream in_;
};

PlainMesh read_obj(const std::string& file) {
  Indexed mesh;
  Words words(file);
  for (std::string word; words.next(word);) {
    if (word == "v") {
      mesh.points.push_back(words.point());
    } else if (word == "f") {
      const std::size_t a = words.index(), b = words.index();
      mesh.faces.push_back({a - 1, b - 1, words.index() - 1});
    } else {
      words.skip_line();
    }
  }
  return mesh.triangles();
}

PlainMesh read_off(const std::string& file) {
  // Comments are separate lines.
  std::string text;
  std::istringstream lines(file);
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with('#')) text += line + "\n";
  Indexed mesh;
  Words words(text);
  EXPECT_EQ(words.word(), "OFF");
  const std::size_t vertices = words.index(), faces = words.index();
  words.index();
  for (std::size_t v = 0; v < vertices; ++v) mesh.points.push_back(words.point());
  for (std::size_t f = 0; f < faces; ++f) {
    EXPECT_EQ(words.index(), 3u);
    const std::size_t a = words.index(), b = words.index();
    mesh.faces.push_back({a, b, words.index()});
  }
  return mesh.triangles();
}

template <class T>
T number_at(const std::string& bytes, std::size_t& at) {
  T value{};
  EXPECT_LE(at + sizeof value, bytes.size());
  if (at + sizeof value > bytes.size()) return value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

template <class T>
Vec3 point_at(const std::string& bytes, std::size_t& at) {
  const double x = number_at<T>(bytes, at), y = number_at<T>(bytes, at);
  return {x, y, number_at<T>(bytes, at)};
}

PlainMesh read_ply(const std::string& file) {
  std::size_t at = file.find("end_header\n") + 11;
  std::size_t vertices = 0, faces = 0, labels = 0;
  std::istringstream header(file.substr(0, at));
  for (std::string line; std::getline(header, line);) {
    std::istringstream words(line);
    std::string first, second;
    words >> first >> second;
    if (first == "element") words >> (second == "vertex" ? vertices : faces);
    if (first == "property" && second == "int") ++labels;
  }
  Indexed mesh;
  for (std::size_t v = 0; v < vertices; ++v) mesh.points.push_back(point_at<double>(file, at));
  for (std::size_t f = 0; f < faces; ++f) {
    EXPECT_EQ(number_at<std::uint8_t>(file, at), 3u);
    const std::size_t a = number_at<std::uint32_t>(file, at), b = number_at<std::uint32_t>(file, at);
    mesh.faces.push_back({a, b, number_at<std::uint32_t>(file, at)});
    at += 4 * labels;
  }
  EXPECT_EQ(at, file.size());
  return mesh.triangles();
}

PlainMesh read_msh(const std::string& file) {
  Indexed mesh;
  Words words(file.substr(file.find("$Nodes\n") + 7));
  std::map<std::size_t, std::size_t> number_of;
  for (std::size_t nodes = words.index(); nodes > 0; --nodes) {
    number_of[words.index()] = mesh.points.size();
    mesh.points.push_back(words.point());
  }
  EXPECT_EQ(words.word(), "$EndNodes");
  EXPECT_EQ(words.word(), "$Elements");
  for (std::size_t elements = words.index(); elements > 0; --elements) {
    words.index();
    EXPECT_EQ(words.index(), 2u);
    for (std::size_t tags = words.index(); tags > 0; --tags) words.index();
    const std::size_t a = number_of.at(words.index()), b = number_of.at(words.index());
    mesh.faces.push_back({a, b, number_of.at(words.index())});
  }
  return mesh.triangles();
}

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int known = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    known += 6;
    if (known < 8) continue;
    known -= 8;
    bytes += static_cast<char>(bits >> known & 255);
  }
  return bytes;
}

/// Returns the numbers of a data array of VTU, which come after their length.
std::string vtu_array(const std::string& file, const std::string& after) {
  const std::size_t element = file.find(after), begin = file.find('>', file.find("<DataArray", element)) + 1;
  const std::string bytes = from_base64(file.substr(begin, file.find('<', begin) - begin));
  std::size_t at = 0;
  EXPECT_EQ(number_at<std::uint64_t>(bytes, at) + at, bytes.size());
  return bytes.substr(at);
}

PlainMesh read_vtu(const std::string& file) {
  Indexed mesh;
  const std::string points = vtu_array(file, "<Points>"), corners = vtu_array(file, "<Cells>");
  for (std::size_t at = 0; at < points.size();) mesh.points.push_back(point_at<double>(points, at));
  for (std::size_t at = 0; at < corners.size();) {
    const auto a = static_cast<std::size_t>(number_at<std::int64_t>(corners, at));
    const auto b = static_cast<std::size_t>(number_at<std::int64_t>(corners, at));
    mesh.faces.push_back({a, b, static_cast<std::size_t>(number_at<std::int64_t>(corners, at))});
  }
  return mesh.triangles();
}

PlainMesh read_binary_stl(const std::string& file) {
  PlainMesh mesh;
  std::size_t at = 80;
  const auto count = number_at<std::uint32_t>(file, at);
  EXPECT_EQ(file.size(), 84 + std::size_t{50} * count);
  for (std::uint32_t f = 0; f < count; ++f) {
    at += 12;
    const Vec3 a = point_at<float>(file, at), b = point_at<float>(file, at);
    mesh.triangles.push_back({a, b, point_at<float>(file, at)});
    at += 2;
  }
  return mesh;
}

PlainMesh read_text_stl(const std::string& file) {
  PlainMesh mesh;
  Words words(file);
  for (std::string word; words.next(word);) {
    EXPECT_EQ(word, "solid");
    const std::string name = words.rest_of_line();
    while (words.next(word) && word == "facet") {
      EXPECT_EQ(words.word(), "normal");
      const Vec3 normal = words.point();
      EXPECT_EQ(words.word(), "outer");
      EXPECT_EQ(words.word(), "loop");
      Corners corners;
      for (Vec3& corner : corners) {
        EXPECT_EQ(words.word(), "vertex");
        corner = words.point();
      }
      EXPECT_NEAR(norm(normal), 1, 1e-6);
      EXPECT_EQ(words.word(), "endloop");
      EXPECT_EQ(words.word(), "endfacet");
      mesh.triangles.push_back(corners);
      mesh.solid_of.push_back(name);
    }
    EXPECT_EQ(word, "endsolid");
    EXPECT_EQ(words.rest_of_line(), name);
  }
  return mesh;
}

}  // namespace

PlainMesh read_plainly(Format format, const std::string& file) {
  switch (format) {
    case Format::kObj: return read_obj(file);
    case Format::kOff: return read_off(file);
    case Format::kPly: return read_ply(file);
    case Format::kMsh: return read_msh(file);
    case Format::kVtu: return read_vtu(file);
    case Format::kStl: return read_binary_stl(file);
    case Format::kStlAscii: return read_text_stl(file);
    case Format::kJson: break;
  }
  ADD_FAILURE() << "no plain reader for " << format_name(format);
  return {};
}

}  // namespace remesh::test
