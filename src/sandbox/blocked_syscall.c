/* SPDX-License-Identifier: BSD-3-Clause */
#include "sandbox/blocked_syscall.h"

#include <inttypes.h>
#include <stdio.h>
#include <sys/syscall.h>

typedef struct kind {
  const char *text;
  int64_t calls[16]; /**< -1 ends the list */
} kind;

/* Newer architectures lack the older forms of some calls. */
#ifndef SYS_open
#define SYS_open -2
#define SYS_creat -2
#define SYS_unlink -2
#define SYS_rename -2
#define SYS_mkdir -2
#define SYS_chmod -2
#define SYS_stat -2
#define SYS_lstat -2
#define SYS_access -2
#define SYS_readlink -2
#define SYS_pipe -2
#define SYS_dup2 -2
#endif
#ifndef SYS_fork
#define SYS_fork -2
#define SYS_vfork -2
#endif
#ifndef SYS_newfstatat
#define SYS_newfstatat -2
#endif
/* Older C libraries lack the names of newer calls, whose numbers are those of every architecture. */
#ifndef SYS_openat2
#define SYS_openat2 437
#endif
#ifndef SYS_faccessat2
#define SYS_faccessat2 439
#endif

static const kind kinds[] = {
    {"open a file", {SYS_open, SYS_openat, SYS_openat2, SYS_creat, SYS_name_to_handle_at, -1}},
    {"change files",
     {SYS_unlink, SYS_unlinkat, SYS_rename, SYS_renameat2, SYS_mkdir, SYS_mkdirat, SYS_truncate,
      SYS_ftruncate, SYS_chmod, SYS_fchmodat, SYS_symlinkat, SYS_linkat, -1}},
    {"look at files",
     {SYS_stat, SYS_lstat, SYS_newfstatat, SYS_fstat, SYS_statx, SYS_access, SYS_faccessat, SYS_faccessat2,
      SYS_readlink, SYS_readlinkat, SYS_getdents64, SYS_chdir, SYS_getcwd, -1}},
    {"use the network",
     {SYS_socket, SYS_socketpair, SYS_connect, SYS_bind, SYS_listen, SYS_sendto, SYS_sendmsg, -1}},
    {"start a process", {SYS_clone, SYS_clone3, SYS_fork, SYS_vfork, -1}},
    {"run a program", {SYS_execve, SYS_execveat, -1}},
    {"signal another process",
     {SYS_kill, SYS_tkill, SYS_tgkill, SYS_rt_sigqueueinfo, SYS_pidfd_open, SYS_pidfd_send_signal, -1}},
    {"look into another process", {SYS_ptrace, SYS_process_vm_readv, SYS_process_vm_writev, -1}},
    {"map memory that is shared or executable", {SYS_mmap, -1}},
    {"make memory executable", {SYS_mprotect, -1}},
    {"make file descriptors",
     {SYS_dup, SYS_dup2, SYS_dup3, SYS_fcntl, SYS_pipe, SYS_pipe2, SYS_memfd_create, SYS_eventfd2,
      SYS_epoll_create1, -1}},
};

void vxm_blocked_syscall_describe(char *out, size_t size, int64_t call) {
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    for (const int64_t *c = kinds[k].calls; *c != -1; c++)
      if (*c == call) {
        snprintf(out, size, "%s", kinds[k].text);
        return;
      }
  snprintf(out, size, "do what a reader may not (system call %" PRId64 ")", call);
}
