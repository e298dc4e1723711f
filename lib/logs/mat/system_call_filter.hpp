// SPDX-License-Identifier: Apache-2.0
/// What a process may ask of the kernel that works on bytes nobody vouches for.
#pragma once

namespace quadtune::internal {

/// From here on this process may read, write and close what it has open, make files in memory, and
/// ask for memory; every other system call fails with EPERM: no file is opened, no socket is made,
/// no process is started. Only a file in memory can be opened by the name that it has in
/// /proc/self, since libmatio opens files by name: it is the open one again, at its beginning. For
/// good, also for what the process would start. A call of another architecture ends the process.
///
/// @return  false where there is no such filter: another processor than x86-64 and AArch64, a
/// kernel
///          without seccomp, or a sandbox that does not let it be set
[[nodiscard]] bool forbid_system_calls();

}  // namespace quadtune::internal
