// SPDX-License-Identifier: Apache-2.0
/// Writing several files whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace quadtune {

/// One file in memory.
struct FileContent {
  std::string name;  ///< within the directory, without a slash, e.g. "K.txt"
  std::string bytes;
};

/// Replaces `files` in `directory`, or leaves the directory as it was.
///
/// Every file is first written to a temporary name beside its target and synced. Only when all are
/// complete does each take its target's place, in the order given, by an atomic exchange; a failure
/// in between exchanges them back. `stale` files are taken away in the same transaction. A crash of
/// the machine in the middle can leave some files new and some old: put the manifest last, then its
/// hashes tell. The directory is made if it is missing, and removed again on failure. Temporaries
/// that a killed writer left, `.NAME.quadtune-tmp`, are removed when all is done.
///
/// @param files        names without a slash, each once
/// @param stale        names of files that must be gone afterwards; absent ones are passed over
/// @param interrupted  asked between the steps; true abandons the work. May be empty.
/// @throws FileError    with the path and the system's reason.
/// @throws Interrupted  when `interrupted` says so.
/// @throws InvalidInput for a name with a slash or given twice.
void write_files(const std::filesystem::path& directory, const std::vector<FileContent>& files,
                 const std::vector<std::string>& stale = {},
                 const std::function<bool()>& interrupted = {});

/// SHA-256 as 64 lowercase hexadecimal digits.
[[nodiscard]] std::string sha256(const std::string& bytes);

/// The same of a file, read piece by piece.
/// @throws FileError  with the path and the system's reason.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace quadtune
