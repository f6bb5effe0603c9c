/// A file that reserves some room on a volume. Deleting jobs needs a little room itself, and on a full volume there
/// would be none.
#pragma once

#include <cstdint>
#include <string>

#include "server/jobs/database.h"

namespace remesh::server::jobs {

class DiskReserve {
 public:
  /// Input: `folder` - a folder on the volume. The size of the reserve is 8 MiB, or a twentieth of a smaller volume.
  explicit DiskReserve(const std::string& folder) : folder_(folder), path_(folder + "/reserve") {}

  /// Makes the file, or makes it longer, as far as there is room. All room that becomes free goes into it first,
  /// because other programs may fill the volume at any time, and then nothing else is left for deletions.
  void keep() const noexcept;
  /// Makes the file shorter by a part of its size, so that this room can be used.
  /// Output: true if there was some.
  bool release() const noexcept;

  /// Checks that the volume has this much room besides the room that stays free: for deletions, and if a new job asks,
  /// also for the results of the existing jobs.
  /// Errors: RoomRefused.
  void check_room(std::uint64_t bytes, RoomFor purpose) const;
  /// The bytes that are free on the volume.
  std::uint64_t free() const { return room().free; }
  /// True if there is so little room that unused room in files should be returned to the file system.
  bool is_scarce() const;

 private:
  struct Room {
    std::uint64_t free = 0;
    std::uint64_t reserve = 0;  ///< the size that the file should have
  };
  Room room() const;

  const std::string folder_;
  const std::string path_;
};

}  // namespace remesh::server::jobs
