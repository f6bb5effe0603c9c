/// Tests the checker's table of edges, with and without an order of the edges that somebody else has made.
#include "core/verify/model/edge_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/adjacency.h"
#include "tests/support/shapes.h"

namespace remesh::verification {
namespace {

std::string text(const Edge& edge) {
  std::string text = std::to_string(edge.low.value) + "-" + std::to_string(edge.high.value) + ":";
  for (const Use& use : edge.uses)
    text +=
        " " + std::to_string(use.patch().value) + "/" + std::to_string(use.half_edge) + (use.is_forward() ? "+" : "-");
  return text;
}

/// Returns everything that a table tells, as text.
std::vector<std::string> contents(const PolygonMesh& mesh, const std::vector<PatchId>& patch,
                                  std::span<const std::uint32_t> order) {
  RunControl control;
  const Faces faces{mesh.face_begin, mesh.corners, patch};
  EdgeTable table(mesh.vertex_count(), faces, order, control);
  std::vector<std::string> told;
  const auto tell = [&](const Edge& edge) { told.push_back(text(edge)); };
  table.for_each_edge(0, mesh.vertex_count(), tell);
  const EdgeCounts counts = table.counts();
  told.push_back(std::to_string(counts.edges) + (counts.is_closed ? " closed" : "") +
                 (counts.is_consistent ? " consistent" : ""));
  for (std::size_t f = 0; f < mesh.face_count(); f += 7) {
    const auto corners = faces.face(f);
    const std::vector<Use> uses = table.find(corners[1], corners[0]);
    told.push_back(text({corners[0], corners[1], uses}));
  }
  told.push_back(std::to_string(table.find(VertexId(0), VertexId(0)).size()));
  const BoundingEdges bounding = table.take_bounding();
  for (const Edge& edge : bounding.edges) tell(edge);
  return told;
}

std::vector<std::uint32_t> order_of(const PolygonMesh& mesh) {
  RunControl control;
  Adjacency edges(mesh.vertex_count(), mesh.face_begin, mesh.corners, control);
  const auto order = std::move(edges).take_order();
  return {order.begin(), order.end()};
}

struct Case {
  std::string name;
  PolygonMesh mesh;
};

std::vector<Case> cases() {
  return {{"a box", shapes::box({3, 2, 1}, 30)},
          {"the same, numbered otherwise", shapes::renumbered(shapes::box({3, 2, 1}, 30), 5)},
          {"quadrangles", shapes::renumbered(shapes::quad_box({3, 2, 1}, 40), 2)},
          {"an edge of three faces", shapes::three_pages(2)},
          {"neighbours that run the same way",
           shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}})},
          {"a face twice", shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 2}, {2, 1, 0}})},
          {"corners repeated",
           shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 1, 2}, {2, 1, 0}, {2, 2, 2}})},
          {"unused vertices",
           shapes::from_lists({{9, 9, 9}, {0, 0, 0}, {8, 8, 8}, {1, 0, 0}, {0, 1, 0}, {7, 7, 7}}, {{1, 3, 4}})}};
}

std::vector<PatchId> some_patches(const PolygonMesh& mesh) {
  std::mt19937 random(3);
  std::vector<PatchId> patch(mesh.face_count());
  for (PatchId& p : patch) p = PatchId(random() % 3);
  return patch;
}

TEST(edge_table, tells_the_same_whoever_has_put_the_edges_in_order) {
  for (const auto& [name, mesh] : cases()) {
    const std::vector<PatchId> patch = some_patches(mesh);
    EXPECT_EQ(contents(mesh, patch, order_of(mesh)), contents(mesh, patch, {})) << name;
  }
}

TEST(edge_table, takes_no_order_that_is_none) {
  using Order = std::vector<std::uint32_t>;
  const std::vector<std::pair<std::string, std::function<void(Order&)>>> spoilers{
      {"backwards", [](Order& order) { std::reverse(order.begin(), order.end()); }},
      {"the first two swapped", [](Order& order) { std::swap(order[0], order[1]); }},
      {"the last two swapped", [](Order& order) { std::swap(order[order.size() - 1], order[order.size() - 2]); }},
      {"halves swapped",
       [](Order& order) { std::rotate(order.begin(), order.begin() + order.size() / 2, order.end()); }},
      {"one twice", [](Order& order) { order[order.size() / 2] = order[order.size() / 2 - 1]; }},
      {"one that is no half-edge", [](Order& order) { order.back() = static_cast<std::uint32_t>(order.size()); }},
      {"none at all", [](Order& order) { order.assign(order.size(), 0xffffffffu); }},
      {"one too few", [](Order& order) { order.pop_back(); }},
      {"one too many", [](Order& order) { order.push_back(order.back()); }},
  };
  for (const auto& [name, mesh] : cases()) {
    const std::vector<PatchId> patch = some_patches(mesh);
    const std::vector<std::string> expected = contents(mesh, patch, {});
    for (const auto& [how, spoil] : spoilers) {
      Order order = order_of(mesh);
      spoil(order);
      EXPECT_EQ(contents(mesh, patch, order), expected) << name << ", " << how;
    }
  }
}

}  // namespace
}  // namespace remesh::verification
