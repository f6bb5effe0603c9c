/// Keeps large answers for clients that read slowly in files instead of memory. Many slow readers of large answers
/// would otherwise hold the memory that other requests need.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "server/http/connection.h"

namespace remesh::server {

class Spool {
 public:
  /// Input: `folder` - where the files are made. They have no names and disappear with their descriptors.
  ///        `max_bytes` - of all files together.
  ///        `max_held` - the memory for answers that find no place in a file, all together.
  Spool(std::string folder, std::uint64_t max_bytes, std::uint64_t max_held);

  /// A file with the bytes of an answer. It exists as long as this object, which the spool must outlive.
  class File {
   public:
    File(File&& other) noexcept
        : spool_(other.spool_), fd_(std::exchange(other.fd_, -1)), size_(std::exchange(other.size_, 0)) {}
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    std::uint64_t size() const { return size_; }
    /// Reads the bytes from `begin` to `end`.
    /// Errors: std::runtime_error - the system cannot read them.
    std::string read(std::uint64_t begin, std::uint64_t end) const;

   private:
    friend class Spool;
    File(Spool& spool, int fd, std::uint64_t size) : spool_(&spool), fd_(fd), size_(size) {}

    Spool* spool_;
    int fd_;
    std::uint64_t size_;
  };
  /// Writes bytes to a file, to be read several times.
  /// Output: nothing if there is no room. Files of this kind have half of the spool at most.
  std::optional<File> keep(std::string_view bytes);

  /// A client that reads a large answer slowly.
  class Reader {
   public:
    Reader(Spool& spool, Connection& connection);
    /// Frees the place of the answer.
    ~Reader();
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    /// Finds a place for the rest of the answer: a file, or memory if no file can take it. As long as there is neither,
    /// the slowest reader is cut off.
    /// Output: true if the rest is in the file `fd()`, so that its memory can be freed.
    /// Errors: ConnectionLost - this is the slowest reader.
    bool place(std::string_view rest);
    int fd() const { return fd_; }
    void record_sent(std::uint64_t bytes) { sent_ += bytes; }

   private:
    friend class Spool;

    double rate() const;

    Spool& spool_;
    Connection& connection_;
    const Clock::time_point start_ = Clock::now();
    std::atomic<std::uint64_t> sent_{0};
    int fd_ = -1;
    std::uint64_t in_file_ = 0;  ///< bytes
    std::uint64_t held_ = 0;     ///< bytes that stay in memory
    bool is_cut_ = false;
  };

  /// True if the spool's files are in memory, because their folder is.
  bool is_in_memory() const { return is_in_memory_; }
  std::uint64_t in_files() const { return in_files_; }
  std::uint64_t held() const { return held_; }

 private:
  /// Output: the descriptor of a file with these bytes; -1 if it cannot be written.
  int write_file(std::string_view bytes) const;
  /// Reserves room for a file.
  bool reserve_file(std::uint64_t bytes);
  void release_file(int fd, std::uint64_t bytes);
  bool reserve_memory(std::uint64_t bytes);
  /// Ends the connection of the slowest reader.
  /// Output: false if that is this reader.
  bool cut_slowest(const Reader& reader);

  const std::string folder_;
  const std::uint64_t max_bytes_;
  const std::uint64_t max_held_;
  const bool is_in_memory_;
  std::mutex mutex_;
  std::set<Reader*> readers_;
  std::atomic<std::uint64_t> in_files_{0};
  std::atomic<std::uint64_t> held_{0};
};

}  // namespace remesh::server
