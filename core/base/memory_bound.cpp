#include "core/base/memory_bound.h"

#include <array>
#include <string>

namespace remesh {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

/// The table of bounds, in the order of the stages. Memory per face is largest where each face is a patch, because each
/// patch has a surface, a plane, a summary and a mesh. Stages before refinement may run again after an attempt has
/// failed, and then also hold the data of that attempt. Each stage may hold 100,000 pairs of faces that intersect.
/// Readers have limits of their own, and writers hold a text of any length.
constexpr std::array<StageMemory, kStageCount> kMemoryOfStages{{
    {0, 0, 0},                // queued
    {0, 0, 0},                // read
    {2400, 200, 12 * kMiB},   // weld, with all mending: up to 4,096 vertices on edges in any case
    {2400, 200, 4 * kMiB},    // regions
    {2400, 200, 4 * kMiB},    // patches
    {2400, 200, 4 * kMiB},    // loops
    {2400, 200, 4 * kMiB},    // essential vertices
    {2400, 400, 4 * kMiB},    // surfaces
    {2800, 600, 4 * kMiB},    // triangulation
    {4000, 1200, 16 * kMiB},  // refinement: up to 2^15 samples of sizes in any case
    {3200, 800, 4 * kMiB},    // assembly
    {4000, 800, 64 * kMiB},   // verify: searches for up to 100,000 pairs of faces that intersect
    {3200, 800, 4 * kMiB},    // quality
    {0, 0, 0},                // write
}};

}  // namespace

StageMemory memory_of(Stage stage) { return kMemoryOfStages[static_cast<std::size_t>(stage)]; }

void MemoryBound::set_input(std::uint64_t faces) {
  input_ = faces;
  output_ = 0;
  update();
}

void MemoryBound::set_output(std::uint64_t faces) {
  output_ = faces;
  update();
}

void MemoryBound::enter(Stage stage) {
  stage_.store(stage, std::memory_order_relaxed);
  update();
}

void MemoryBound::update() {
  const Stage stage = stage_.load(std::memory_order_relaxed);
  const bool has_row = memory_of(stage).per_input_face > 0;
  allowed_.store(has_row ? memory_of(stage).bytes(input_, output_) : kNone, std::memory_order_relaxed);
}

void MemoryBound::refuse(double bytes) const {
  const Stage stage = stage_.load(std::memory_order_relaxed);
  const auto in_mib = [](double b) { return std::to_string(static_cast<std::uint64_t>(b / kMiB)) + " MiB"; };
  throw Error(Code::kOutOfMemory, stage,
              "the stage `" + std::string(stage_name(stage)) + "` needs " + in_mib(bytes) +
                  " for one of its lists, and all of them may take " + in_mib(static_cast<double>(allowed())) +
                  " for a mesh of this size")
      .with_limit(allowed());
}

}  // namespace remesh
