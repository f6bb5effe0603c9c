#include "server/jobs/blob_table.h"

#include <algorithm>

#include <chrono>

#include "server/jobs/row_values.h"

namespace remesh::server::jobs {
namespace {

/// Files older than this belong to no running transaction. No transaction takes nearly as long, even if the clocks of
/// file servers differ.
constexpr std::chrono::hours kStrayAge{24};
/// The largest number of parts that one statement removes, so that none takes long: 16 MiB.
constexpr std::int64_t kRemovedParts = 16 * DatabaseDriver::kPartsOfPiece;

const char* kind_name(BlobKind kind) {
  switch (kind) {
    case BlobKind::kInput: return "input";
    case BlobKind::kMesh: return "mesh";
    case BlobKind::kReport: return "report";
  }
  return "";
}

BlobLost lost(const std::string& id, std::string_view kind) {
  return BlobLost("a part of the " + std::string(kind) + " of job " + id + " is missing in the store");
}

}  // namespace

void BlobTable::write(Database& database, const std::string& id, BlobKind kind, std::string_view bytes) const {
  const std::string_view name = kind_name(kind);
  const std::uint64_t size = bytes.size();
  if (folder_) {
    const std::string file = folder_->write(id, name, bytes);
    database.run("INSERT INTO remeshd_blob (job, kind, part, file, size) VALUES ($1, $2, 0, $3, $4)",
                 {std::string_view(id), name, std::string_view(file), static_cast<std::int64_t>(size)});
    return;
  }
  std::int64_t part = 0;
  do {
    const std::string_view piece = bytes.substr(0, DatabaseDriver::kPiece);
    driver_.insert_piece(database, id, name, part, piece, size);
    database.extend_deadline(timeout_);
    part += DatabaseDriver::kPartsOfPiece;
    bytes.remove_prefix(piece.size());
  } while (!bytes.empty());
}

/// Looks at the first and the last row of a blob. It reads no data, which for a large blob would take longer than the
/// store may take to answer.
std::optional<BlobTable::Extent> BlobTable::extent(Database& database, const std::string& id,
                                                   std::string_view kind) const {
  const Rows rows = database.run(
      "SELECT file, size, (SELECT max(part) FROM remeshd_blob WHERE job = $1 AND kind = $2) FROM remeshd_blob "
      "WHERE job = $1 AND kind = $2 ORDER BY part LIMIT 1",
      {std::string_view(id), kind});
  database.extend_deadline(timeout_);
  if (rows.empty()) return std::nullopt;
  const Row& first = rows[0];
  Extent extent{first[0], std::nullopt, integer(first[2])};
  if (extent.file || !first[1]) return extent;
  // All pieces but the last one are full.
  const std::int64_t size = integer(first[1]);
  const std::int64_t full = std::max<std::int64_t>(0, extent.last_part) / DatabaseDriver::kPartsOfPiece;
  constexpr auto kPiece = static_cast<std::int64_t>(DatabaseDriver::kPiece);
  if (size < full * kPiece || size > (full + 1) * kPiece) throw lost(id, kind);
  extent.size = static_cast<std::uint64_t>(size);
  return extent;
}

std::optional<BlobTable::Blob> BlobTable::find(Database& database, const std::string& id, BlobKind kind) const {
  const std::string_view name = kind_name(kind);
  const std::optional<Extent> extent = this->extent(database, id, name);
  if (!extent) return std::nullopt;
  if (extent->file) return Blob{"", extent->file};
  std::string bytes;
  if (extent->size) bytes.reserve(*extent->size);
  std::int64_t count = 0;
  for (std::int64_t part = 0; part <= extent->last_part; part += DatabaseDriver::kPartsOfPiece) {
    const Rows piece = database.run(
        "SELECT data FROM remeshd_blob WHERE job = $1 AND kind = $2 AND part >= $3 AND part < $4 ORDER BY part",
        {std::string_view(id), name, part, part + DatabaseDriver::kPartsOfPiece}, Database::Result::kBytes);
    database.extend_deadline(timeout_);
    if (piece.empty()) break;
    for (const Row& row : piece) bytes += row[0].value_or("");
    count += static_cast<std::int64_t>(piece.size());
  }
  // An older version of the daemon stored no size. Then only the rows in the middle are certain to exist.
  if (extent->size && bytes.size() == *extent->size) return Blob{std::move(bytes), {}};
  if (!this->extent(database, id, name)) return std::nullopt;  // the blob expired meanwhile
  if (extent->size || count != driver_.rows_of_blob(extent->last_part)) throw lost(id, name);
  return Blob{std::move(bytes), {}};
}

std::optional<BlobTable::Size> BlobTable::size(Database& database, const std::string& id, BlobKind kind) const {
  const std::string_view name = kind_name(kind);
  const std::optional<Extent> extent = this->extent(database, id, name);
  if (!extent) return std::nullopt;
  if (extent->file || extent->size) return Size{extent->size.value_or(0), extent->file};
  // An older version of the daemon stored no size.
  Size size;
  for (std::int64_t part = 0; part <= extent->last_part; part += DatabaseDriver::kPartsOfPiece) {
    const Rows piece = database.run(
        "SELECT coalesce(sum(length(data)), 0), count(*) FROM remeshd_blob WHERE job = $1 AND kind = $2 "
        "AND part >= $3 AND part < $4",
        {std::string_view(id), name, part, part + DatabaseDriver::kPartsOfPiece});
    database.extend_deadline(timeout_);
    if (integer(piece.at(0)[1]) == 0) break;
    size.bytes += static_cast<std::uint64_t>(integer(piece[0][0]));
  }
  return size;
}

std::vector<std::string> BlobTable::remove(Database& database, const std::string& id, const char* condition) const {
  const std::string rows =
      " FROM remeshd_blob WHERE job = $1 AND " + std::string(condition) + " AND (kind, part) > ($2, $3)";
  const std::string find_last = "SELECT kind, part" + rows + " ORDER BY kind, part LIMIT 1 OFFSET $4";
  const std::string remove_rest = "DELETE" + rows + " RETURNING file";
  const std::string remove_piece = "DELETE" + rows + " AND (kind, part) <= ($4, $5) RETURNING file";
  const std::int64_t count = driver_.rows_of_blob(kRemovedParts - 1);
  std::vector<std::string> files;
  std::string kind;  // all rows up to this one are removed
  std::int64_t part = -1;
  for (bool is_done = false; !is_done;) {
    const Rows last = database.run(find_last.c_str(), {std::string_view(id), std::string_view(kind), part, count - 1});
    is_done = last.empty();
    Rows removed;
    if (is_done) {
      removed = database.run(remove_rest.c_str(), {std::string_view(id), std::string_view(kind), part});
    } else {
      const std::string last_kind = last[0][0].value();
      const std::int64_t last_part = integer(last[0][1]);
      removed = database.run(remove_piece.c_str(), {std::string_view(id), std::string_view(kind), part,
                                                    std::string_view(last_kind), last_part});
      kind = last_kind;
      part = last_part;
    }
    database.extend_deadline(timeout_);
    for (const Row& row : removed) {
      if (row[0]) files.push_back(*row[0]);
    }
  }
  return files;
}

const BlobFolder& BlobTable::folder() const {
  if (!folder_) throw NoFolder("the inputs and results of jobs are in a folder, but --blob-dir is not set");
  return *folder_;
}

void BlobTable::remove_files(const std::vector<std::string>& files) const {
  if (!folder_) return;
  for (const std::string& file : files) folder_->remove(file);
}

std::vector<std::string> BlobTable::find_stray_files(Database& database, int part) const {
  std::vector<std::string> files;
  if (!folder_) return files;
  for (const BlobFolder::Found& file : folder_->files_older_than(kStrayAge, part % BlobFolder::kParts)) {
    const Rows rows = database.run("SELECT part FROM remeshd_blob WHERE job = $1 AND file = $2",
                                   {std::string_view(file.job), std::string_view(file.name)});
    if (rows.empty()) files.push_back(file.name);
  }
  return files;
}

}  // namespace remesh::server::jobs
