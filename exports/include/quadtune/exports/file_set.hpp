// SPDX-License-Identifier: Apache-2.0
/// Writes several files atomically.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace quadtune {

/// One file in memory.
struct FileContent {
  std::string name;   ///< within the directory, without a slash, e.g. "K.txt"
  std::string bytes;  ///< content of the file
};

/// Replaces `files` in `directory`, or leaves the directory unchanged.
///
/// Every file is first written to a temporary file next to its target and synced. When all are
/// complete, each replaces its target by an atomic exchange, in the given order; after a failure
/// the exchanges are undone. `stale` files are deleted in the same transaction. If the machine
/// crashes in between, some files can be new and others old: put the manifest last, so that its
/// hashes reveal this state. A missing directory is created, and removed again on failure.
/// Temporary files that a killed writer left, `.NAME.quadtune-tmp`, are removed at the end.
///
/// @param directory    created if it is missing
/// @param files        names without a slash, each at most once
/// @param stale        names of files to delete; missing ones are ignored
/// @param interrupted  called between the steps; the transaction is undone if it returns true; may
///                     be empty
/// @throws FileError    with the path and the system's reason
/// @throws Interrupted  if `interrupted` returns true
/// @throws InvalidInput  if a name contains a slash or occurs twice
void write_files(const std::filesystem::path& directory, const std::vector<FileContent>& files,
                 const std::vector<std::string>& stale = {},
                 const std::function<bool()>& interrupted = {});

/// SHA-256 as 64 lowercase hexadecimal digits.
[[nodiscard]] std::string sha256(const std::string& bytes);

/// The same for a file, which is read in blocks.
/// @throws FileError  with the path and the system's reason
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace quadtune
