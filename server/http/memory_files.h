/// Files that are in memory, because their file system is. What lies there counts toward the memory budget.
#pragma once

#include <cstdint>
#include <string>

namespace remesh::server {

/// True if the files of this folder are in memory.
bool is_memory_folder(const std::string& folder);
/// True if this open file is in memory.
bool is_memory_file(int file);

/// The bytes that nameless files of this process take in memory, as far as they are mapped nowhere: what is mapped
/// counts as resident.
std::uint64_t memory_file_bytes();
void add_memory_file_bytes(std::int64_t bytes);

}  // namespace remesh::server
