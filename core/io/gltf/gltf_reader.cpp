#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/io/common/affine_map.h"
#include "core/io/common/base64.h"
#include "core/io/common/bytes.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/gltf/gltf.h"

namespace remesh {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kGlbMark = "glTF";

Error gltf_error(const std::string& message) { return read_error(Place::byte(0), Code::kInvalidMesh, message); }

/// Access to members of JSON, of which none has to be there and none has to have the right type.
const Json* member(const Json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}
std::optional<std::uint64_t> number_of(const Json* value) {
  if (value == nullptr) return std::nullopt;
  if (value->is_number_unsigned()) return value->get<std::uint64_t>();
  if (value->is_number_float() && *value >= 0 && *value < 0x1p53 && std::floor(value->get<double>()) == *value)
    return static_cast<std::uint64_t>(value->get<double>());
  throw gltf_error("a number in the JSON is no whole number: " + cited(value->dump()));
}
std::uint64_t number(const Json& object, const char* name, std::uint64_t otherwise) {
  return number_of(member(object, name)).value_or(otherwise);
}
std::string text(const Json& object, const char* name) {
  const Json* const value = member(object, name);
  if (value == nullptr) return "";
  if (!value->is_string()) throw gltf_error(std::string("the member ") + name + " is no text");
  return value->get<std::string>();
}
/// An item of one of the arrays at the top of glTF.
const Json& item(const Json& document, const char* array, std::uint64_t index) {
  const Json* const items = member(document, array);
  if (items == nullptr || !items->is_array() || index >= items->size() || !(*items)[index].is_object())
    throw gltf_error("there is no " + std::string(array) + "[" + std::to_string(index) + "]");
  return (*items)[index];
}

template <std::size_t N>
std::optional<std::array<double, N>> numbers(const Json& object, const char* name) {
  const Json* const values = member(object, name);
  if (values == nullptr) return std::nullopt;
  std::array<double, N> result;
  if (!values->is_array() || values->size() != N) throw gltf_error(std::string("the member ") + name + " of a node");
  for (std::size_t i = 0; i < N; ++i) {
    if (!(*values)[i].is_number()) throw gltf_error(std::string("the member ") + name + " of a node");
    result[i] = (*values)[i].template get<double>();
  }
  return result;
}

AffineMap map_of(const Json& node) {
  // A file by write_glb has its own axes in this node only for programs that show it.
  if (const Json* extras = member(node, "extras"); extras != nullptr && text(*extras, "remeshd") == "z_up") return {};
  if (const auto m = numbers<16>(node, "matrix")) {
    const auto column = [&](std::size_t i) { return Vec3{(*m)[4 * i], (*m)[4 * i + 1], (*m)[4 * i + 2]}; };
    return {{column(0), column(1), column(2)}, column(3)};
  }
  AffineMap map;
  const auto [x, y, z, w] = numbers<4>(node, "rotation").value_or(std::array<double, 4>{0, 0, 0, 1});
  map.columns = {{{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                  {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                  {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}}};
  const auto scale = numbers<3>(node, "scale").value_or(std::array<double, 3>{1, 1, 1});
  for (std::size_t i = 0; i < 3; ++i) map.columns[i] = scale[i] * map.columns[i];
  const auto [tx, ty, tz] = numbers<3>(node, "translation").value_or(std::array<double, 3>{0, 0, 0});
  map.origin = {tx, ty, tz};
  return map;
}

/// The numbers of an accessor, where they stand.
struct AccessorView {
  std::string_view bytes;  ///< from the first number on; empty: all numbers are 0
  std::uint64_t count = 0, stride = 0;
  std::uint64_t type = 0;  ///< glTF's number of the type of a component
  bool is_normalized = false;

  static std::size_t size_of(std::uint64_t type) {
    switch (type) {
      case 5120:
      case 5121: return 1;
      case 5122:
      case 5123: return 2;
      case 5125:
      case 5126: return 4;
      default: return 0;
    }
  }
  /// Indices may not be signed, and the real value of a negative one is no index.
  bool may_be_indices() const { return !is_normalized && (type == 5121 || type == 5123 || type == 5125); }
  double real(std::uint64_t i, std::size_t component) const {
    if (bytes.empty()) return 0;
    const char* const at = bytes.data() + i * stride + component * size_of(type);
    constexpr ByteOrder kOrder = ByteOrder::kLittle;
    const auto normal = [&](double value, double most) { return is_normalized ? std::max(value / most, -1.0) : value; };
    switch (type) {
      case 5120: return normal(load<std::int8_t>(at, kOrder), 127);
      case 5121: return normal(load<std::uint8_t>(at, kOrder), 255);
      case 5122: return normal(load<std::int16_t>(at, kOrder), 32767);
      case 5123: return normal(load<std::uint16_t>(at, kOrder), 65535);
      case 5125: return load<std::uint32_t>(at, kOrder);
      default: return static_cast<double>(load<float>(at, kOrder));
    }
  }
};

class GltfReader {
 public:
  GltfReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), limits_(limits), control_(control), builder_(limits, control) {}

  ReadResult read() {
    parse();
    check_document();
    load_buffers();
    visit_nodes();
    ReadResult result;
    result.mesh = builder_.take();
    result.mesh.labels.object = objects_.take();
    result.mesh.labels.material = materials_.take();
    if (!has_own_axes_) {
      result.unit = "meter";
      result.up_axis = "y";
    }
    record_dropped(
        "normals, colours, points, lines, skins and other data that is no surface were dropped; number of primitives "
        "that had some",
        dropped_, result.diagnostics);
    return result;
  }

 private:
  void parse() {
    std::string_view json = content_;
    if (content_.starts_with(kGlbMark)) {
      ByteReader bytes(content_, kGlbMark.size(), ByteOrder::kLittle);
      if (bytes.take<std::uint32_t>() != 2) throw gltf_error("only version 2 of glTF is read");
      bytes.skip(sizeof(std::uint32_t));
      json = chunk(bytes, "JSON");
      // A file without data has no second chunk.
      if (bytes.left() >= 8) binary_ = chunk(bytes, std::string_view("BIN\0", 4));
    }
    // Each value in the document stands behind one of these characters.
    const auto values =
        std::count_if(json.begin(), json.end(), [](char c) { return c == ',' || c == ':' || c == '[' || c == '{'; });
    control_.memory().ask_for<std::pair<std::string, Json>>(static_cast<std::size_t>(values) + 1);
    try {
      document_ = Json::parse(json.begin(), json.end());
    } catch (const Json::exception& error) {
      throw gltf_error("the JSON of glTF cannot be read: " + cited(error.what()));
    }
  }

  std::string_view chunk(ByteReader& bytes, std::string_view type) {
    const std::uint32_t length = bytes.take<std::uint32_t>();
    const std::size_t begin = bytes.offset();
    if (content_.substr(begin, 4) != type)
      throw read_error(bytes.place(), Code::kInvalidMesh, "a chunk of another type than " + cited(type));
    bytes.skip(4);
    bytes.skip(length);
    return content_.substr(begin + 4, length);
  }

  void check_document() {
    const Json* const asset = member(document_, "asset");
    if (asset == nullptr || !text(*asset, "version").starts_with("2")) throw gltf_error("not glTF of version 2");
    const Json* const required = member(document_, "extensionsRequired");
    if (required == nullptr || !required->is_array()) return;
    for (const Json& name : *required) {
      const std::string extension = name.is_string() ? name.get<std::string>() : name.dump();
      const auto begins = [&](std::string_view with) { return extension.starts_with(with); };
      const bool is_harmless = extension == "KHR_mesh_quantization" || begins("KHR_materials_") ||
                               begins("KHR_texture_") || begins("KHR_lights_") || begins("EXT_texture_");
      if (!is_harmless) throw gltf_error("the extension " + cited(extension) + " is required, but not read");
    }
  }

  void load_buffers() {
    const Json* const buffers = member(document_, "buffers");
    if (buffers == nullptr || !buffers->is_array()) return;
    for (const Json& buffer : *buffers) {
      control_.check();
      const std::string* const uri = uri_of(buffer);
      if (uri == nullptr) {
        if (!buffers_.empty()) throw gltf_error("a buffer without data");
        buffers_.push_back(binary_);
        continue;
      }
      constexpr std::string_view kBase64 = ";base64,";
      const std::size_t mark = uri->find(kBase64);
      if (!uri->starts_with("data:") || mark == std::string::npos)
        throw gltf_error("a buffer is in another file (" + cited(*uri) +
                         "); export glTF with embedded buffers, or as .glb");
      buffers_.push_back(
          decoded_.emplace_back(from_base64(std::string_view(*uri).substr(mark + kBase64.size()), uri->size())));
    }
  }
  static const std::string* uri_of(const Json& buffer) {
    const Json* const uri = member(buffer, "uri");
    return uri == nullptr || !uri->is_string() ? nullptr : &uri->get_ref<const std::string&>();
  }

  /// Visits the nodes of the scene. `first` is pushed with their children before, so that they come in their order.
  void visit_nodes() {
    const Json* const nodes = member(document_, "nodes");
    const std::size_t n = nodes != nullptr && nodes->is_array() ? nodes->size() : 0;
    std::vector<std::uint8_t> is_visited(n, 0);
    struct Visit {
      std::uint64_t node;
      AffineMap map;
    };
    std::vector<Visit> stack;
    const auto push = [&](const std::vector<std::uint64_t>& indices, const AffineMap& map) {
      for (auto index = indices.rbegin(); index != indices.rend(); ++index) stack.push_back({*index, map});
    };
    push(root_nodes(n), {});
    while (!stack.empty()) {
      control_.check();
      const Visit visit = stack.back();
      stack.pop_back();
      const Json& node = item(document_, "nodes", visit.node);
      if (std::exchange(is_visited[visit.node], 1) != 0) throw gltf_error("the nodes are no tree");
      const Json* const extras = member(node, "extras");
      has_own_axes_ = has_own_axes_ || (extras != nullptr && text(*extras, "remeshd") == "z_up");
      const AffineMap map = visit.map.after(map_of(node));
      if (const auto mesh = number_of(member(node, "mesh"))) add_mesh(item(document_, "meshes", *mesh), *mesh, map);
      push(indices_of(node, "children"), map);
    }
  }
  std::vector<std::uint64_t> indices_of(const Json& object, const char* name) const {
    std::vector<std::uint64_t> indices;
    const Json* const items = member(object, name);
    if (items == nullptr || !items->is_array()) return indices;
    for (const Json& index : *items) indices.push_back(number_of(&index).value());
    return indices;
  }
  std::vector<std::uint64_t> root_nodes(std::size_t n) const {
    const Json* const scenes = member(document_, "scenes");
    if (scenes != nullptr && scenes->is_array() && !scenes->empty())
      return indices_of(item(document_, "scenes", number(document_, "scene", 0)), "nodes");
    std::vector<std::uint8_t> is_child(n, 0);
    for (std::size_t i = 0; i < n; ++i)
      for (const std::uint64_t child : indices_of(item(document_, "nodes", i), "children"))
        if (child < n) is_child[child] = 1;
    std::vector<std::uint64_t> roots;
    for (std::size_t i = 0; i < n; ++i)
      if (is_child[i] == 0) roots.push_back(i);
    return roots;
  }

  void add_mesh(const Json& mesh, std::uint64_t index, const AffineMap& map) {
    const std::string name = text(mesh, "name");
    const Json* const primitives = member(mesh, "primitives");
    if (primitives == nullptr || !primitives->is_array()) throw gltf_error("a mesh without primitives");
    // Primitives share vertices by their accessor. This is the first vertex of each.
    std::map<std::uint64_t, std::uint64_t> first_vertex;
    // A mesh that is alone and has no name is no object beside others.
    const bool has_name = member(mesh, "name") != nullptr;
    if (has_name || document_.at("meshes").size() > 1) objects_.name(has_name ? name : "mesh_" + std::to_string(index));
    for (const Json& primitive : *primitives) {
      // Nodes may use a mesh again and again that has nothing but lines.
      if (++primitives_ > limits_.max_faces) throw too_large_error(Place::byte(0), "primitives", limits_.max_faces);
      add_primitive(primitive, map, first_vertex);
    }
  }

  void add_primitive(const Json& primitive, const AffineMap& map,
                     std::map<std::uint64_t, std::uint64_t>& first_vertex) {
    const std::uint64_t mode = number(primitive, "mode", 4);
    const Json* const attributes = member(primitive, "attributes");
    const auto position = attributes == nullptr ? std::nullopt : number_of(member(*attributes, "POSITION"));
    if (mode < 4 || mode > 6 || !position) {
      ++dropped_;
      return;
    }
    if (attributes->size() > 1 || member(primitive, "targets") != nullptr) ++dropped_;
    const AccessorView points = view(*position, "VEC3");
    const auto [known, is_new] = first_vertex.try_emplace(*position, vertices_);
    if (is_new) add_points(points, map);
    const std::uint64_t base = known->second;

    const auto indices = number_of(member(primitive, "indices"));
    const AccessorView corners = indices ? view(*indices, "SCALAR") : AccessorView{};
    if (indices && !corners.may_be_indices()) throw gltf_error("indices that are no whole numbers without a sign");
    const std::uint64_t n = indices ? corners.count : points.count;
    const auto corner = [&](std::uint64_t i) -> std::int64_t {
      const std::uint64_t vertex = indices ? static_cast<std::uint64_t>(corners.real(i, 0)) : i;
      return vertex < points.count ? static_cast<std::int64_t>(base + vertex) : -1;
    };
    const std::uint64_t faces = mode == 4 ? n / 3 : n < 3 ? 0 : n - 2;
    if (mode == 4 && n % 3 != 0) throw gltf_error("a list of triangles whose number of indices is no multiple of 3");
    if (faces > limits_.max_faces - builder_.mesh().face_count())
      throw too_large_error(Place::byte(0), "faces", limits_.max_faces);
    const auto material = number_of(member(primitive, "material"));
    materials_.name(material ? material_name(*material) : "");
    objects_.add_faces(builder_.mesh().face_count(), static_cast<std::size_t>(faces));
    materials_.add_faces(builder_.mesh().face_count(), static_cast<std::size_t>(faces));
    for (std::uint64_t f = 0; f < faces; ++f) {
      builder_.tick(0, 1);
      std::array<std::uint64_t, 3> at{f, f + 1 + f % 2, f + 2 - f % 2};  // a strip
      if (mode == 4) at = {3 * f, 3 * f + 1, 3 * f + 2};
      if (mode == 6) at = {f + 1, f + 2, 0};  // a fan
      if (map.turns_over()) std::swap(at[1], at[2]);
      builder_.begin_face(3, Place::byte(0));
      for (const std::uint64_t i : at) builder_.add_corner(corner(i), Place::byte(0));
    }
  }

  std::string material_name(std::uint64_t index) const {
    const Json& material = item(document_, "materials", index);
    return member(material, "name") == nullptr ? "material_" + std::to_string(index) : text(material, "name");
  }

  void add_points(const AccessorView& points, const AffineMap& map) {
    if (points.count > limits_.max_vertices - vertices_)
      throw too_large_error(Place::byte(0), "vertices", limits_.max_vertices);
    vertices_ += points.count;
    builder_.announce(vertices_, 0, 0, 0, Place::byte(0));
    for (std::uint64_t i = 0; i < points.count; ++i) {
      builder_.tick(0, 1);
      builder_.add_vertex(map({points.real(i, 0), points.real(i, 1), points.real(i, 2)}), Place::byte(0));
    }
  }

  AccessorView view(std::uint64_t index, std::string_view type) const {
    const Json& accessor = item(document_, "accessors", index);
    const std::string where = "accessors[" + std::to_string(index) + "]";
    if (text(accessor, "type") != type) throw gltf_error(where + " is no " + std::string(type));
    if (member(accessor, "sparse") != nullptr) throw gltf_error(where + " is sparse, which is not read");
    AccessorView result;
    result.count = number(accessor, "count", 0);
    result.type = number(accessor, "componentType", 0);
    const Json* const normalized = member(accessor, "normalized");
    result.is_normalized = normalized != nullptr && *normalized == true;
    const std::uint64_t size = (type == "VEC3" ? 3 : 1) * AccessorView::size_of(result.type);
    if (size == 0) throw gltf_error(where + " has numbers of a type that is not known");
    if (result.count > std::max(limits_.max_vertices, 3 * limits_.max_faces))
      throw too_large_error(Place::byte(0), "items of an accessor",
                            std::max(limits_.max_vertices, 3 * limits_.max_faces));
    const auto view_index = number_of(member(accessor, "bufferView"));
    if (!view_index) throw gltf_error(where + " has no data");
    const Json& buffer_view = item(document_, "bufferViews", *view_index);
    const std::uint64_t buffer = number(buffer_view, "buffer", 0);
    if (buffer >= buffers_.size()) throw gltf_error("there is no buffer " + std::to_string(buffer));
    const std::string_view all = buffers_[buffer];
    const std::uint64_t view_begin = number(buffer_view, "byteOffset", 0),
                        view_size = number(buffer_view, "byteLength", 0);
    const std::uint64_t offset = number(accessor, "byteOffset", 0);
    result.stride = number(buffer_view, "byteStride", size);
    // Nothing overflows, because each summand is at most the size of the buffer.
    const bool fits = view_begin <= all.size() && view_size <= all.size() - view_begin && offset <= view_size &&
                      result.stride >= size && result.stride <= 252 + size &&
                      (result.count == 0 || (result.count - 1) * result.stride + size <= view_size - offset);
    if (!fits) throw gltf_error(where + " does not fit into its buffer");
    result.bytes = all.substr(static_cast<std::size_t>(view_begin + offset));
    return result;
  }

  std::string_view content_;
  const ReadLimits& limits_;
  RunControl& control_;
  MeshBuilder builder_;
  Json document_;
  std::string_view binary_;
  std::deque<std::string> decoded_;  ///< does not move its items
  std::vector<std::string_view> buffers_;
  LabelCollector objects_, materials_;
  std::uint64_t vertices_ = 0, primitives_ = 0, dropped_ = 0;
  bool has_own_axes_ = false;
};

}  // namespace

bool is_gltf_json(std::string_view text) {
  return text.find("\"asset\"") != std::string_view::npos && text.find("\"bufferViews\"") != std::string_view::npos;
}

ReadResult read_gltf(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return GltfReader(content, limits, control).read();
}

}  // namespace remesh
