#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/text_lines.h"
#include "core/io/obj/obj_chunk.h"
#include "core/io/obj/obj_readers.h"

namespace remesh {
namespace {

/// Size of the text that is parsed at once. The parsed chunk stays in a core's cache until it is gathered.
constexpr std::size_t kChunkSize = std::size_t{1} << 18;

/// Splits text into chunks of whole lines. A chunk has the size above, or one long line more.
class Chunks {
 public:
  explicit Chunks(std::string_view text) {
    const std::size_t last_line = text.find_last_of("\n\r") + 1;
    if (last_line < text.size()) last_line_.append(text.substr(last_line)) += '\n';
    text = text.substr(0, last_line);
    while (!text.empty()) {
      std::size_t size = std::min(kChunkSize, text.size());
      while (!is_line_end(text[size - 1])) ++size;
      chunks_.push_back(text.substr(0, size));
      text.remove_prefix(size);
    }
    if (!last_line_.empty()) chunks_.push_back(last_line_);
  }
  Chunks(const Chunks&) = delete;
  Chunks& operator=(const Chunks&) = delete;

  std::size_t size() const { return chunks_.size(); }
  std::string_view operator[](std::size_t i) const { return chunks_[i]; }

 private:
  std::string last_line_;  ///< a copy of the last line if that has no line end
  std::vector<std::string_view> chunks_;
};

/// Joins the names of a `g` record into one.
std::string joined_names(std::string_view names) {
  std::string joined;
  bool is_between = false;
  for (const char c : names) {
    const bool is_gap = c == ' ' || c == '\t';
    if (!is_gap && is_between) joined += ' ';
    if (!is_gap) joined += c;
    is_between = is_gap;
  }
  return joined;
}

/// Appends the chunks to the mesh one after another.
class Gatherer {
 public:
  Gatherer(std::size_t chunks, const ReadLimits& limits) : chunks_left_(chunks), limits_(limits) {}

  /// Input:  `size` - the length of the chunk's text.
  /// Output: false if the chunk does not fit those before it, or exceeds a limit.
  bool add(ObjChunk chunk, std::size_t size) {
    const double share = share_of_faces(chunk, size);
    reserve(mesh_.positions.items(), chunk.positions.size(), 1, limits_.max_vertices);
    reserve(mesh_.corners, chunk.corners.size(), share, PolygonMesh::kMaxCorners);
    reserve(mesh_.face_begin, chunk.face_end.size(), share, limits_.max_faces);
    --chunks_left_;
    if (!resolve(chunk)) return false;
    add_labels(chunk);
    note(chunk.extras);
    const auto corners_before = static_cast<std::uint32_t>(mesh_.corners.size());
    mesh_.face_begin.resize(mesh_.face_begin.size() + chunk.face_end.size());
    std::transform(chunk.face_end.begin(), chunk.face_end.end(), mesh_.face_begin.end() - chunk.face_end.size(),
                   [&](std::uint32_t end) { return corners_before + end; });
    mesh_.corners.insert(mesh_.corners.end(), chunk.corners.begin(), chunk.corners.end());
    mesh_.positions.items().insert(mesh_.positions.end(), chunk.positions.begin(), chunk.positions.end());
    largest_index_ = std::max(largest_index_, chunk.largest_index);
    return mesh_.vertex_count() <= limits_.max_vertices && mesh_.face_count() <= limits_.max_faces &&
           extras_.dropped.kinds().size() < DroppedRecords::kMaxKinds;
  }

  /// Output: nothing if a face has a vertex that the text does not have, or if there is no face.
  std::optional<ReadResult> finish() {
    if (largest_index_ > mesh_.vertex_count() || mesh_.face_count() == 0) return std::nullopt;
    mesh_.labels.object = labels_[static_cast<std::size_t>(ObjChunk::LabelKind::kObject)].take();
    mesh_.labels.group = labels_[static_cast<std::size_t>(ObjChunk::LabelKind::kGroup)].take();
    mesh_.labels.material = labels_[static_cast<std::size_t>(ObjChunk::LabelKind::kMaterial)].take();
    return ReadResult{std::move(mesh_), std::move(extras_).diagnostics()};
  }

 private:
  /// Estimates the share of a chunk's text that its faces take. Faces take a part of the chunk in which the vertices
  /// end, and all of the chunks after it.
  double share_of_faces(const ObjChunk& chunk, std::size_t size) {
    constexpr double kLeast = 1.0 / 64;
    if (chunk.face_end.empty() && !chunk.positions.empty())
      bytes_per_vertex_ = static_cast<double>(size) / static_cast<double>(chunk.positions.size());
    const double of_vertices = bytes_per_vertex_ * static_cast<double>(chunk.positions.size());
    return std::clamp(1 - of_vertices / static_cast<double>(size), kLeast, 1.0);
  }

  /// Reserves room for the items to add. If the memory does not suffice, it also reserves as much for each of the
  /// remaining chunks, assuming that `share` of the text gives that many items. Memory that is not written to costs
  /// nothing, but moving the items would.
  template <class T>
  void reserve(std::vector<T>& items, std::size_t added, double share, std::uint64_t most) const {
    if (items.size() + added <= items.capacity()) return;
    constexpr std::uint64_t kMaxInChunk = kChunkSize / 4;
    const std::uint64_t per_chunk = std::clamp(static_cast<std::uint64_t>(static_cast<double>(added) / share),
                                               std::uint64_t{added}, std::max(std::uint64_t{added}, kMaxInChunk));
    const std::uint64_t wanted = items.size() + per_chunk * chunks_left_ + per_chunk / 8;
    const std::uint64_t least = items.size() + added;
    items.reserve(static_cast<std::size_t>(std::max(least, std::min(wanted, most))));
  }

  /// Converts relative indices to absolute ones.
  bool resolve(ObjChunk& chunk) const {
    if (chunk.corners.size() > PolygonMesh::kMaxCorners - mesh_.corners.size()) return false;
    for (const std::uint32_t corner : chunk.relative) {
      VertexId& vertex = chunk.corners[corner];
      const std::int64_t index =
          static_cast<std::int64_t>(mesh_.vertex_count()) + static_cast<std::int32_t>(vertex.value);
      if (index < 0) return false;
      vertex = VertexId(static_cast<std::uint32_t>(index));
    }
    return true;
  }

  void add_labels(const ObjChunk& chunk) {
    std::size_t face = 0;
    for (const ObjChunk::Label& label : chunk.labels) {
      add_faces(label.face - face);
      face = label.face;
      labels_[static_cast<std::size_t>(label.kind)].name(
          label.kind == ObjChunk::LabelKind::kGroup ? joined_names(label.name) : std::string(label.name));
    }
    add_faces(chunk.face_end.size() - face);
    for (const std::string_view files : chunk.material_libraries) mesh_.labels.material_libraries.emplace_back(files);
  }

  void add_faces(std::size_t count) {
    for (LabelCollector& labels : labels_) labels.add_faces(faces_labelled_, count);
    faces_labelled_ += count;
  }

  void note(const ObjExtras& found) {
    for (const auto& [keyword, count] : found.dropped.kinds()) extras_.dropped.count(keyword, count);
    note(found.extra_values, extras_.extra_values);
    note(found.missing_z, extras_.missing_z);
  }

  void note(const Diagnostic& found, Diagnostic& all) const {
    all.count += found.count;
    for (const std::uint64_t vertex : found.elements) {
      if (all.elements.size() < Diagnostic::kMaxElements) all.elements.push_back(mesh_.vertex_count() + vertex);
    }
  }

  std::size_t chunks_left_;
  double bytes_per_vertex_ = 0;  ///< measured in the last chunk that had only vertices
  const ReadLimits& limits_;
  PolygonMesh mesh_;
  std::array<LabelCollector, 3> labels_;
  std::size_t faces_labelled_ = 0;
  std::uint32_t largest_index_ = 0;
  ObjExtras extras_;
};

}  // namespace

std::optional<ReadResult> read_obj_fast_path(std::string_view text, const ReadLimits& limits, RunControl& control) {
  if (wide_encoding(text)) return std::nullopt;
  if (text.starts_with(kUtf8Mark)) text.remove_prefix(kUtf8Mark.size());
  const Chunks chunks(without_padding(text));
  Gatherer gatherer(chunks.size(), limits);
  const bool is_plain = map_in_order<std::optional<ObjChunk>>(
      chunks.size(), control, [&](std::size_t i) { return parse_obj_chunk(chunks[i]); },
      [&](std::size_t i, std::optional<ObjChunk> chunk) {
        control.progress(static_cast<double>(i + 1) / static_cast<double>(chunks.size()));
        return chunk && gatherer.add(std::move(*chunk), chunks[i].size());
      });
  return is_plain ? gatherer.finish() : std::nullopt;
}

}  // namespace remesh
