#include "api/result_archive.h"

#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <type_traits>

#include "core/io/formats.h"

namespace remesh::api {
namespace {

static_assert(std::endian::native == std::endian::little, "archives are little-endian");
static_assert(sizeof(Vec3) == 24);

/// The last digit is the version of the format.
constexpr std::string_view kMagic = "REMESHD8";
/// The versions that are read. Before version 7 there were neither choices of how the result is written nor the axis
/// that points upwards, and before version 8 there were no colours of glTF.
constexpr char kOldest = '6', kWithWriting = '7', kWithColours = '8';

constexpr std::uint32_t value_of(std::uint32_t number) { return number; }
template <class Tag>
constexpr std::uint32_t value_of(Id<Tag> id) {
  return id.value;
}

/// Lists the corners of all triangles one after another.
std::vector<VertexId> corners_of(const TriangleMesh& mesh) {
  std::vector<VertexId> corners;
  corners.reserve(mesh.faces.size() * 3);
  for (const Triangle& face : mesh.faces) corners.insert(corners.end(), face.begin(), face.end());
  return corners;
}

class Packer {
 public:
  void number(std::uint64_t value) { append(&value, sizeof value); }
  void real(double value) { append(&value, sizeof value); }
  void text(std::string_view value) {
    number(value.size());
    append(value.data(), value.size());
  }
  void texts(const std::vector<std::string>& values) {
    number(values.size());
    for (const std::string& value : values) text(value);
  }
  template <class T>
  void array(const std::vector<T>& items) {
    static_assert(std::is_trivially_copyable_v<T>);
    number(items.size());
    append(items.data(), items.size() * sizeof(T));
  }
  /// Writes numbers of which neighbours are mostly close. Each is stored as its difference from the one before, in as
  /// few bytes as possible.
  template <class Items>
  void ids(const Items& items) {
    number(items.size());
    std::uint32_t last = 0;
    for (const auto& item : items) {
      const std::uint32_t value = value_of(item);
      const std::uint32_t distance = value - last;  // modulo 2^32, so that no id needs a special case
      std::uint32_t zigzag = (distance << 1) ^ (0u - (distance >> 31));
      for (; zigzag >= 0x80; zigzag >>= 7) out_ += static_cast<char>(zigzag | 0x80);
      out_ += static_cast<char>(zigzag);
      last = value;
    }
  }
  void labels(const LabelSet& set) {
    texts(set.names);
    ids(set.of_face.items());
  }
  void reserve(std::size_t bytes) { out_.reserve(bytes); }
  void append(const void* bytes, std::size_t size) {
    if (size > 0) out_.append(static_cast<const char*>(bytes), size);
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

  std::uint64_t number() {
    std::uint64_t value = 0;
    std::memcpy(&value, cut(sizeof value).data(), sizeof value);
    return value;
  }
  double real() {
    double value = 0;
    std::memcpy(&value, cut(sizeof value).data(), sizeof value);
    return value;
  }
  bool flag() {
    const std::uint64_t value = number();
    if (value > 1) fail();
    return value == 1;
  }
  UnrefinedReason reason() {
    const std::uint64_t value = number();
    if (value >= kUnrefinedReasonCount) fail();
    return static_cast<UnrefinedReason>(value);
  }
  /// Reads a value of an enumeration.
  template <class Value>
  Value choice(Value last) {
    const std::uint64_t value = number();
    if (value > static_cast<std::uint64_t>(last)) fail();
    return static_cast<Value>(value);
  }
  std::string text() { return std::string(cut(number())); }
  std::vector<std::string> texts() {
    std::vector<std::string> values;
    for (std::uint64_t count = number(); count > 0; --count) values.push_back(text());
    return values;
  }
  template <class T>
  void array(std::vector<T>& items) {
    const std::uint64_t count = number();
    if (count > rest_.size() / sizeof(T)) fail();
    items.resize(count);
    const std::string_view bytes = cut(count * sizeof(T));
    if (!bytes.empty()) std::memcpy(items.data(), bytes.data(), bytes.size());
  }
  template <class Item>
  void ids(std::vector<Item>& items) {
    const std::uint64_t count = number();
    if (count > rest_.size()) fail();
    items.reserve(count);
    std::uint32_t last = 0;
    for (std::uint64_t i = 0; i < count; ++i) items.emplace_back(last += distance());
  }
  void labels(LabelSet& set) {
    set.names = texts();
    ids(set.of_face.items());
  }
  /// Reads the character behind the bytes that must come first.
  char version_behind(std::string_view bytes) {
    if (cut(bytes.size()) != bytes) fail();
    return cut(1).front();
  }
  void expect_end() const {
    if (!rest_.empty()) fail();
  }
  [[noreturn]] static void fail() {
    throw Error(Code::kInternal, Stage::kWrite, "the stored result is damaged or was written by another version");
  }

 private:
  std::uint32_t distance() {
    std::uint32_t zigzag = 0;
    for (int shift = 0;; shift += 7) {
      if (rest_.empty() || shift > 28) fail();
      const auto byte = static_cast<unsigned char>(rest_.front());
      rest_.remove_prefix(1);
      zigzag |= std::uint32_t{byte & 0x7fu} << shift;
      if (byte < 0x80) return (zigzag >> 1) ^ (0u - (zigzag & 1));
    }
  }
  std::string_view cut(std::uint64_t size) {
    if (size > rest_.size()) fail();
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }

  std::string_view rest_;
};

void pack(const Writing& writing, Packer& out) {
  out.number(static_cast<std::uint64_t>(writing.label));
  out.number(static_cast<std::uint64_t>(writing.names));
  out.number(static_cast<std::uint64_t>(writing.stl_solids));
  out.number(static_cast<std::uint64_t>(writing.msh_version));
  out.number(static_cast<std::uint64_t>(writing.glb_colours));
}

void unpack(Unpacker& in, Writing& writing, char version) {
  if (version < kWithWriting) return;
  writing.label = in.choice(LabelChoice::kSurface);
  writing.names = in.choice(NameRule::kExact);
  writing.stl_solids = in.choice(StlSolids::kOne);
  writing.msh_version = in.choice(MshVersion::k41);
  if (version >= kWithColours) writing.glb_colours = in.choice(GlbColours::kQuality);
}

void pack(const Summary& summary, Packer& out) {
  for (const std::uint64_t count : {summary.input_faces, summary.output_faces, summary.patches, summary.kept})
    out.number(count);
  out.real(summary.min_angle_deg);
  out.number(summary.is_verified);
  out.texts(summary.warnings);
  out.number(summary.unrefined.size());
  for (const auto& [reason, count] : summary.unrefined) {
    out.number(static_cast<std::uint64_t>(reason));
    out.number(count);
  }
  out.number(summary.distance_bound.has_value());
  if (!summary.distance_bound) return;
  out.real(summary.distance_bound->output_to_input);
  out.real(summary.distance_bound->input_to_output);
}

void unpack(Unpacker& in, Summary& summary) {
  for (std::uint64_t* count : {&summary.input_faces, &summary.output_faces, &summary.patches, &summary.kept})
    *count = in.number();
  summary.min_angle_deg = in.real();
  summary.is_verified = in.flag();
  summary.warnings = in.texts();
  for (std::uint64_t reasons = in.number(); reasons > 0; --reasons) {
    const UnrefinedReason reason = in.reason();
    summary.unrefined.emplace_back(reason, in.number());
  }
  if (!in.flag()) return;
  DistanceBound& bound = summary.distance_bound.emplace();
  bound.output_to_input = in.real();
  bound.input_to_output = in.real();
}

/// The numbers of the goals in a fixed order, used by both packing and unpacking.
template <class TheGoals>
auto reals_of(TheGoals& goals) {
  return std::array{&goals.min_angle_deg, &goals.max_edge_length,     &goals.max_area,  &goals.min_edge_length,
                    &goals.proximity,     &goals.min_edge_of_storage, &goals.gradation, &goals.feature_angle_deg};
}

template <class Labels>
auto numbers_of(Labels& labels) {
  return std::array{&labels.set_of, &labels.begin, &labels.labels};
}

void pack(const RoundingInput& basis, Packer& out) {
  out.array(basis.normals.items());
  out.array(basis.is_curved.items());
  out.real(basis.allowed_move);
  out.number(basis.is_refined);
  for (const double* value : reals_of(basis.goals)) out.real(*value);
  out.number(basis.goals.max_faces);
  out.number(basis.goals.faces_without_min_edge);
  out.number(basis.goals.split_boundaries);
  out.ids(basis.unrefined.faces);
  for (const UnrefinedReason reason : basis.unrefined.reasons) out.number(static_cast<std::uint64_t>(reason));
  out.array(basis.unrefined.misses_sizes);
  std::vector<PatchId> pairs;
  for (const auto& [p, q] : basis.intersections.patches) pairs.insert(pairs.end(), {p, q});
  out.ids(pairs);
  out.number(basis.intersections.is_complete);
  for (const auto* numbers : numbers_of(basis.patch_labels)) out.ids(*numbers);
}

void unpack(Unpacker& in, RoundingInput& basis) {
  in.array(basis.normals.items());
  in.array(basis.is_curved.items());
  basis.allowed_move = in.real();
  basis.is_refined = in.flag();
  for (double* value : reals_of(basis.goals)) *value = in.real();
  basis.goals.max_faces = in.number();
  basis.goals.faces_without_min_edge = in.number();
  basis.goals.split_boundaries = in.flag();
  in.ids(basis.unrefined.faces);
  for (std::size_t i = 0; i < basis.unrefined.faces.size(); ++i) basis.unrefined.reasons.push_back(in.reason());
  in.array(basis.unrefined.misses_sizes);
  if (basis.unrefined.misses_sizes.size() != basis.unrefined.faces.size()) Unpacker::fail();
  std::vector<PatchId> pairs;
  in.ids(pairs);
  if (pairs.size() % 2 != 0) Unpacker::fail();
  for (std::size_t i = 0; i < pairs.size(); i += 2) basis.intersections.patches.emplace_back(pairs[i], pairs[i + 1]);
  basis.intersections.is_complete = in.flag();
  for (auto* numbers : numbers_of(basis.patch_labels)) {
    numbers->clear();
    in.ids(*numbers);
  }
}

}  // namespace

std::string pack_result(const KeptResult& kept) {
  constexpr std::size_t kPerFace = 12;  // an estimate
  const Result& result = kept.result;
  Packer out;
  out.reserve(4096 + kept.exact_report.size() + result.mesh.positions.size() * sizeof(Vec3) +
              result.mesh.faces.size() * kPerFace);
  out.append(kMagic.data(), kMagic.size());
  out.text(format_name(kept.format));
  out.number(kept.local_origin);
  pack(kept.writing, out);
  pack(kept.summary, out);
  out.text(kept.server_timing);
  out.text(kept.file_name);
  out.text(kept.exact_report);
  out.array(result.mesh.positions.items());
  out.ids(corners_of(result.mesh));
  out.labels(result.mesh.labels.object);
  out.labels(result.mesh.labels.group);
  out.labels(result.mesh.labels.material);
  out.texts(result.mesh.labels.material_libraries);
  out.ids(result.face_patch.items());
  out.ids(result.report.surfaces.of_patch.items());
  out.text(result.report.input_up_axis);
  out.ids(result.face_source.items());
  out.ids(result.input_face_patch.items());
  pack(result.rounding_input, out);
  return out.take();
}

KeptResult unpack_result(std::string_view bytes) {
  Unpacker in(bytes);
  const char version = in.version_behind(kMagic.substr(0, kMagic.size() - 1));
  if (version < kOldest || version > kMagic.back()) Unpacker::fail();
  KeptResult kept;
  Result& result = kept.result;
  const std::optional<Format> format = format_from_name(in.text());
  if (!format) Unpacker::fail();
  kept.format = *format;
  kept.local_origin = in.flag();
  unpack(in, kept.writing, version);
  unpack(in, kept.summary);
  kept.server_timing = in.text();
  kept.file_name = in.text();
  kept.exact_report = in.text();
  in.array(result.mesh.positions.items());
  std::vector<VertexId> corners;
  in.ids(corners);
  if (corners.size() % 3 != 0) Unpacker::fail();
  result.mesh.faces.reserve(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    result.mesh.faces.push_back({corners[i], corners[i + 1], corners[i + 2]});
  in.labels(result.mesh.labels.object);
  in.labels(result.mesh.labels.group);
  in.labels(result.mesh.labels.material);
  result.mesh.labels.material_libraries = in.texts();
  in.ids(result.face_patch.items());
  in.ids(result.report.surfaces.of_patch.items());
  if (version >= kWithWriting) result.report.input_up_axis = in.text();
  in.ids(result.face_source.items());
  in.ids(result.input_face_patch.items());
  unpack(in, result.rounding_input);
  in.expect_end();
  return kept;
}

}  // namespace remesh::api
