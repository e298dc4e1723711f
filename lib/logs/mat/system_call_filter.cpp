// SPDX-License-Identifier: Apache-2.0
// Source: seccomp(2) and libseccomp; opening by a handler of SIGSYS as in Chromium's sandbox.
#include "logs/mat/system_call_filter.hpp"

#include <seccomp.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <string_view>
#include <system_error>

namespace quadtune::internal {
namespace {

#if defined(__x86_64__) || defined(__aarch64__)

struct Registers {
  long long path;     // the first argument of open(), the second of openat()
  long long* result;  // where the call's result goes
};

Registers registers_of(ucontext_t& state, [[maybe_unused]] int call) {
#if defined(__x86_64__)
  greg_t* const r = state.uc_mcontext.gregs;
  return {call == SYS_open ? r[REG_RDI] : r[REG_RSI], &r[REG_RAX]};
#else
  auto* const r = reinterpret_cast<long long*>(state.uc_mcontext.regs);
  return {r[1], &r[0]};
#endif
}

// What the process has open as `path`, from its beginning; or an error as the kernel would say it.
long long reopened(std::string_view path) {
  constexpr std::string_view kOpen = "/proc/self/fd/";
  if (!path.starts_with(kOpen)) return -EPERM;
  path.remove_prefix(kOpen.size());
  int descriptor = -1;
  const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), descriptor);
  if (error != std::errc() || end != path.data() + path.size()) return -EPERM;
  const int again = ::dup(descriptor);
  if (again < 0) return -errno;
  // Only a file has a beginning: a pipe cannot be opened.
  if (::lseek(again, 0, SEEK_SET) == 0) return again;
  ::close(again);
  return -EPERM;
}

// Only calls that a process may make in a handler: open() was one.
void open_by_name(int, siginfo_t* info, void* context) {
  const int kept = errno;
  const Registers registers = registers_of(*static_cast<ucontext_t*>(context), info->si_syscall);
  *registers.result = reopened(reinterpret_cast<const char*>(registers.path));
  errno = kept;
}

// What zlib, matio, the C library's memory and files, and the sanitizers need.
constexpr std::array kAllowed = {
    SCMP_SYS(read),          SCMP_SYS(write),        SCMP_SYS(readv),
    SCMP_SYS(writev),        SCMP_SYS(pread64),      SCMP_SYS(pwrite64),
    SCMP_SYS(lseek),         SCMP_SYS(close),        SCMP_SYS(dup),
    SCMP_SYS(fstat),         SCMP_SYS(ftruncate),    SCMP_SYS(fcntl),
    SCMP_SYS(memfd_create),  SCMP_SYS(mmap),         SCMP_SYS(munmap),
    SCMP_SYS(mremap),        SCMP_SYS(mprotect),     SCMP_SYS(madvise),
    SCMP_SYS(brk),           SCMP_SYS(futex),        SCMP_SYS(getrandom),
    SCMP_SYS(clock_gettime), SCMP_SYS(sched_yield),  SCMP_SYS(getpid),
    SCMP_SYS(gettid),        SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(rt_sigreturn),  SCMP_SYS(sigaltstack),  SCMP_SYS(restart_syscall),
#if defined(__SANITIZE_ADDRESS__)
    SCMP_SYS(pipe2),  // by which UBSan asks whether memory is readable
#endif
    SCMP_SYS(exit),          SCMP_SYS(exit_group)};

bool load_filter(scmp_filter_ctx filter) {
  for (const int call : kAllowed)
    if (seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0) != 0) return false;
  // fstat() of newer C libraries: of a descriptor alone, not of a name.
  constexpr scmp_datum_t kEmptyPath = 0x1000;  // AT_EMPTY_PATH
  if (seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(newfstatat), 1,
                       SCMP_A3(SCMP_CMP_EQ, kEmptyPath)) != 0)
    return false;
  // abort() ends the process itself.
  if (seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1,
                       SCMP_A0(SCMP_CMP_EQ, static_cast<scmp_datum_t>(::getpid()))) != 0)
    return false;
  for (const int call : {SCMP_SYS(open), SCMP_SYS(openat)})
    if (seccomp_rule_add(filter, SCMP_ACT_TRAP, call, 0) != 0) return false;
  return seccomp_load(filter) == 0;
}

#endif

}  // namespace

bool forbid_system_calls() {
#if defined(__x86_64__) || defined(__aarch64__)
  struct sigaction opening {};
  opening.sa_sigaction = open_by_name;
  opening.sa_flags = SA_SIGINFO | SA_NODEFER;
  if (::sigaction(SIGSYS, &opening, nullptr) != 0) return false;
  sigset_t unblocked;
  ::sigemptyset(&unblocked);
  ::sigaddset(&unblocked, SIGSYS);
  if (::sigprocmask(SIG_UNBLOCK, &unblocked, nullptr) != 0) return false;
  const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
  if (filter == nullptr) return false;
  const bool loaded = load_filter(filter);
  seccomp_release(filter);
  return loaded;
#else
  return false;
#endif
}

}  // namespace quadtune::internal
