/// Finds the collection of real meshes beside the project.
///
/// The collection may be missing. A test that needs a file of it asks `has_shared_mesh` first, which marks the test as
/// skipped if the file is missing. With the environment variable REMESHD_REQUIRE_CORPUS=1 the test fails instead, so
/// that a run that was meant to have the collection cannot succeed without it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace remesh::test {

/// Returns the folder of the collection. It is `../shared/meshes` beside the sources, unless the environment variable
/// REMESHD_CORPUS names another folder.
std::filesystem::path shared_meshes_folder();

/// True if the environment variable REMESHD_REQUIRE_CORPUS is 1.
bool is_corpus_required();

/// Tells whether a file or folder of the collection is there. If it is not, the running test is marked as skipped, or
/// as failed if the collection is required; the message names what is missing. The caller then returns. A fixture may
/// call this in SetUp, which ends the test in both cases.
/// Input: `name` - the path within the collection; empty for the collection itself.
bool has_shared_mesh(const std::string& name = {});

/// A row of a table: what stands in each column, by the column's name.
using TableRow = std::map<std::string, std::string>;

/// Reads a table whose first line has the names of the columns. Tabs separate the columns.
/// Output: the rows in their order, each with every column; empty if there is no file.
std::vector<TableRow> read_table(const std::filesystem::path& path);

/// The columns of the collection's table for one file. `file` is its name within the collection.
using MeshFacts = TableRow;

/// Returns the facts of all files in the table's order. Every file has every column.
/// Output: empty if the collection is missing.
std::vector<MeshFacts> shared_meshes_facts();

}  // namespace remesh::test
