#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/grouping.h"
#include "core/base/number_text.h"
#include "core/base/rounded_to_float.h"
#include "core/io/common/bytes.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/gltf/gltf.h"
#include "core/mesh/quality.h"

namespace remesh {
namespace {

/// The members of a node that turns the z axis upwards, and says that readers need not.
constexpr std::string_view kZUp = ",\"matrix\":[1,0,0,0,0,0,-1,0,0,1,0,0,0,0,0,1],\"extras\":{\"remeshd\":\"z_up\"}";

/// Makes a text in JSON, in valid UTF-8.
std::string json_text(std::string_view text) {
  std::string json = "\"";
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text.front();
    if (c == '"' || c == '\\') {
      json += {'\\', c};
    } else if (length == 0) {
      json += '?';
    } else {
      json += is_control_character(c) ? " " : text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return json + "\"";
}

/// A colour of which neighbours in the order differ much: the hue goes on by the golden ratio.
std::string colour(std::size_t i) {
  std::string rgb = "[";
  const double hue = std::fmod(0.6180339887498949 * static_cast<double>(i), 1);
  for (const double shift : {0.0, 2.0 / 3, 1.0 / 3}) {
    const double at = std::fabs(std::fmod(hue + shift, 1) * 6 - 3) - 1;
    rgb += number_text(0.15 + 0.6 * std::clamp(at, 0.0, 1.0), 3) + ",";
  }
  return rgb + "1]";
}

/// The primitives of the file: the faces of one colour each.
struct ColouredParts {
  Grouping faces;
  std::vector<std::string> names, colours;
};

ColouredParts parts_by_label(const WriterInput& input, RunControl& control) {
  constexpr std::uint32_t kMaxColours = 256;
  WriterInput named = input;
  named.writing.names = NameRule::kExact;
  const Boundaries boundaries(named, control);
  const bool are_many = boundaries.size() > kMaxColours;
  const std::size_t count = are_many ? kMaxColours : boundaries.size();
  ColouredParts parts;
  parts.faces = group_by(
      input.mesh.faces.size(), count, [&](std::uint32_t f) { return boundaries.of(FaceId(f)) % kMaxColours; }, control);
  for (std::size_t part = 0; part < count; ++part) {
    const bool is_used = !parts.faces[part].empty();
    parts.names.push_back(are_many  ? std::string("colour_").append(std::to_string(part))
                          : is_used ? boundaries.name(part)
                                    : std::string());
    parts.colours.push_back(colour(part));
  }
  return parts;
}

ColouredParts parts_by_quality(const TriangleMesh& mesh, RunControl& control) {
  constexpr std::uint32_t kStep = 5, kCount = 60 / kStep;
  const IdVector<FaceId, FaceQuality> quality = face_quality(mesh, control);
  ColouredParts parts;
  parts.faces = group_by(
      mesh.faces.size(), kCount,
      [&](std::uint32_t f) {
        return static_cast<std::uint32_t>(std::min(quality[FaceId(f)].min_angle_deg / kStep, kCount - 1.0));
      },
      control);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double share = i / (kCount - 1.0);
    parts.names.push_back(std::string("min_angle_").append(std::to_string(i * kStep)));
    std::string colour = "[";
    colour.append(number_text(std::min(1.0, 2 - 2 * share) * 0.8, 3)).append(",");
    colour.append(number_text(std::min(1.0, 2 * share) * 0.7, 3)).append(",0.1,1]");
    parts.colours.push_back(std::move(colour));
  }
  return parts;
}

std::string point_text(const Vec3& p) {
  std::string text;
  append_point(text, p);
  std::replace(text.begin(), text.end(), ' ', ',');
  text.insert(text.begin(), '[');
  return text + "]";
}

void append_chunk(std::string& out, std::string_view type, std::string_view data) {
  append_little_endian(out, static_cast<std::uint32_t>(data.size()));
  out.append(type).append(data);
}

}  // namespace

std::string write_glb(const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  const TriangleMesh& mesh = input.mesh;
  const ColouredParts parts = input.writing.glb_colours == GlbColours::kQuality ? parts_by_quality(mesh, control)
                                                                                : parts_by_label(input, control);
  constexpr std::uint64_t kMaxBytes = std::numeric_limits<std::uint32_t>::max() - (std::uint64_t{1} << 24);
  const std::uint64_t position_bytes = 12 * std::uint64_t{mesh.positions.size()};
  const std::uint64_t index_bytes = 12 * std::uint64_t{mesh.faces.size()};
  if (position_bytes + index_bytes > kMaxBytes)
    throw Error(Code::kOutputTooLarge, Stage::kWrite, "more bytes than glTF can count").with_limit(kMaxBytes);
  std::string data;
  data.reserve(static_cast<std::size_t>(position_bytes + index_bytes));
  WriteProgress progress(mesh.positions.size() + mesh.faces.size(), control);
  Box3 box;
  for (const Vec3& p : mesh.positions) {
    progress.tick();
    if (!is_finite(p) || rounded_to_float(p) != p)
      throw Error(Code::kInternal, Stage::kWrite, "a coordinate that is no float was to be written as glTF");
    box.add(p);
    for (int axis = 0; axis < 3; ++axis) append_little_endian(data, static_cast<float>(p[axis]));
  }
  std::string primitives, materials, accessors;
  std::size_t count = 0;
  for (std::size_t part = 0; part < parts.names.size(); ++part) {
    if (parts.faces[part].empty()) continue;
    const std::string_view separator = count++ == 0 ? "" : ",";
    accessors.append(",{\"bufferView\":1,\"byteOffset\":").append(std::to_string(data.size() - position_bytes));
    accessors.append(",\"componentType\":5125,\"count\":").append(std::to_string(3 * parts.faces[part].size()));
    accessors.append(",\"type\":\"SCALAR\"}");
    for (const std::uint32_t f : parts.faces[part]) {
      progress.tick();
      for (const VertexId v : mesh.faces[FaceId(f)]) append_little_endian(data, v.value);
    }
    primitives.append(separator).append("{\"attributes\":{\"POSITION\":0},\"indices\":").append(std::to_string(count));
    primitives.append(",\"material\":").append(std::to_string(count - 1)).append("}");
    materials.append(separator)
        .append("{\"name\":")
        .append(json_text(parts.names[part]))
        .append(",\"doubleSided\":true,");
    materials.append("\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0.8,\"baseColorFactor\":");
    materials.append(parts.colours[part]).append("}}");
  }
  std::string comments;
  for (const std::string& comment : input.comments)
    for (const std::string& line : comment_lines(comment))
      comments.append(comments.empty() ? "" : ",").append(json_text(line));

  std::string json = "{\"asset\":{\"version\":\"2.0\",\"generator\":\"remeshd\",\"extras\":{\"comments\":[";
  json.append(comments).append("]}},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0");
  json.append(input.is_y_up ? "" : kZUp).append("}],\"meshes\":[{\"primitives\":[").append(primitives);
  json.append("]}],\"materials\":[").append(materials).append("],\"accessors\":[{\"bufferView\":0,");
  json.append("\"componentType\":5126,\"count\":").append(std::to_string(mesh.positions.size()));
  json.append(",\"type\":\"VEC3\",\"min\":").append(point_text(box.min)).append(",\"max\":");
  json.append(point_text(box.max)).append("}").append(accessors).append("],\"bufferViews\":[{\"buffer\":0,");
  json.append("\"byteLength\":").append(std::to_string(position_bytes)).append(",\"target\":34962},{\"buffer\":0,");
  json.append("\"byteOffset\":").append(std::to_string(position_bytes)).append(",\"byteLength\":");
  json.append(std::to_string(index_bytes)).append(",\"target\":34963}],\"buffers\":[{\"byteLength\":");
  json.append(std::to_string(data.size())).append("}]}");
  json.resize((json.size() + 3) / 4 * 4, ' ');

  constexpr std::size_t kHead = 12, kChunkHead = 8;
  std::string out = "glTF";
  out.reserve(kHead + 2 * kChunkHead + json.size() + data.size());
  append_little_endian(out, std::uint32_t{2});
  append_little_endian(out, static_cast<std::uint32_t>(kHead + 2 * kChunkHead + json.size() + data.size()));
  append_chunk(out, "JSON", json);
  append_chunk(out, std::string_view("BIN\0", 4), data);
  return out;
}

}  // namespace remesh
