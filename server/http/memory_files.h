/// Files that are in memory, because their file system is. Their bytes count toward the memory budget.
#pragma once

#include <cstdint>
#include <string>

namespace remesh::server {

/// True if the files of this folder are in memory.
bool is_memory_folder(const std::string& folder);
/// True if this open file is in memory.
bool is_memory_file(int file);

/// The bytes of nameless files of this process that are in memory and not mapped. Mapped bytes count as resident.
std::uint64_t memory_file_bytes();
void add_memory_file_bytes(std::int64_t bytes);

}  // namespace remesh::server
