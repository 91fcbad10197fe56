/* SPDX-License-Identifier: BSD-3-Clause */
/** A module that does what the file tells it: everything that a foreign library may do to its process. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/module.h"
#include "config.h"
#include "sandbox/reader.h"

static vxm_status make_strip(vxm_soup *soup, size_t faces, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint32_t tag = 0;
  for (size_t v = 0; v < faces + 2 && status == VXM_OK; v++)
    status = vxm_soup_add_vertex(soup, (double)v, (double)(v % 2), 0.5, error);
  for (size_t f = 0; f < faces && status == VXM_OK; f++) {
    uint32_t corners[3] = {(uint32_t)f, (uint32_t)f + 1, (uint32_t)f + 2};
    status = vxm_soup_add_face(soup, corners, 3, error);
  }
  if (status == VXM_OK)
    status = vxm_soup_add_tag(soup, "first", 5, &tag, error);
  if (status == VXM_OK)
    status = vxm_soup_add_tag(soup, "", 0, &tag, error);
  if (status != VXM_OK)
    return status;
  soup->face_tags = vxm_alloc(soup->context, faces, sizeof *soup->face_tags, error);
  for (size_t f = 0; f < faces && soup->face_tags; f++)
    soup->face_tags[f] = (uint32_t)(f % 2);
  vxm_warn(&soup->warnings, "a warning\nof two lines");
  return soup->face_tags ? VXM_OK : error->code;
}

/** Takes what there is, without asking much at once. */
static vxm_status take_all(vxm_soup *soup, vxm_error *error) {
  enum { PIECE = 1 << 20 };
  for (;;) {
    void *block = vxm_alloc(soup->context, PIECE, 1, error);
    if (!block)
      return error->code;
    memset(block, 1, PIECE);
  }
}

static void *volatile block; /* so that nothing is left out as useless */

/** Asks for more than there is, in the way that stands behind the word, and does without. */
static void do_without(const vxm_reader_request *request) {
  size_t much = PTRDIFF_MAX / 2;
  void *aligned = NULL;
  switch (request->data[request->size - 1]) {
  case 'm':
    block = malloc(much);
    break;
  case 'c':
    block = calloc(much / 16, 16);
    break;
  case 'r':
    block = realloc(block, much);
    break;
  case 'a':
    block = aligned_alloc(64, much);
    break;
  case 'p':
    if (posix_memalign(&aligned, 64, much) == 0)
      block = aligned;
    break;
  }
}

/** What fails for another reason than want of memory, or does not fail. */
static void ask_oddly(void) {
  void *aligned = NULL;
  errno = ENOMEM;
  block = realloc(malloc(1), 0);
  if (posix_memalign(&aligned, 3, 1) == 0)
    raise(SIGABRT);
  block = calloc(0, 8);
}

static vxm_status wait_for_ever(vxm_soup *soup, vxm_error *error) {
  for (double fraction = 0.25;; fraction = 0.5) {
    vxm_status status = vxm_progress(soup->context, "reading", fraction, error);
    if (status != VXM_OK)
      return status;
    usleep(1000);
  }
}

static void send_rubbish(void) {
  static const uint64_t kinds[] = {77, 0};
  if (write(STDIN_FILENO, kinds, sizeof kinds) < 0)
    raise(SIGABRT);
}

/** A header of a soup (see wire_format.c) whose counts no memory holds, or whose arrays contradict them. */
static void send_lies(bool is_huge) {
  const uint64_t most = is_huge ? UINT64_MAX / 3 : 1;
  const uint64_t header[] = {3, most, most, is_huge ? most : 3, 0, 0, 0};
  const double corner[3] = {0, 0, 0};
  const uint64_t offsets[2] = {0, 3};
  const uint32_t indices[3] = {0, 1, 2}; /* of one vertex */
  bool sent =
      write(STDIN_FILENO, header, sizeof header) > 0 && write(STDIN_FILENO, corner, sizeof corner) > 0 &&
      write(STDIN_FILENO, offsets, sizeof offsets) > 0 && write(STDIN_FILENO, indices, sizeof indices) > 0;
  if (!sent)
    raise(SIGABRT);
}

static void print_much(void) {
  for (int i = 0; i < 100000; i++) {
    printf("chatter on standard output\n");
    fprintf(stderr, "chatter on standard error\n");
  }
  fflush(stdout);
}

/* ---- What a file that has taken the library over would try ---- */

/** Where nothing should appear. */
static const char trace[] = "/tmp/voxmend-ill-trace";

static long try_open(void) {
  return open("/etc/passwd", O_RDONLY);
}

static long try_openat(void) {
  return openat(AT_FDCWD, "/etc/hostname", O_RDONLY | O_NONBLOCK);
}

static long try_creat(void) {
  return creat(trace, 0600);
}

static long try_fopen(void) {
  return fopen("/proc/self/maps", "r") ? 0 : -1;
}

static long try_stat(void) {
  struct stat info;
  return stat("/root", &info);
}

static long try_opendir(void) {
  return opendir("/") ? 0 : -1;
}

static long try_unlink(void) {
  return unlink("/tmp/voxmend-ill-victim");
}

static long try_socket(void) {
  return socket(AF_INET, SOCK_STREAM, 0);
}

static long try_connect(void) {
  struct sockaddr_un address = {.sun_family = AF_UNIX, .sun_path = "/run/nowhere"};
  return connect(STDOUT_FILENO, (struct sockaddr *)&address, sizeof address);
}

static long try_fork(void) {
  pid_t id = fork();
  if (id == 0)
    for (;;)
      pause();
  return id;
}

static void *sit(void *payload) {
  return payload;
}

static long try_thread(void) {
  pthread_t thread;
  return pthread_create(&thread, NULL, sit, NULL);
}

static long try_execve(void) {
  char *const arguments[] = {(char *)(uintptr_t) "sh", NULL};
  return execve("/bin/sh", arguments, NULL);
}

static long try_system(void) {
  return system("touch /tmp/voxmend-ill-trace");
}

/** A thread that was there before the filter, as libraries may start them when they are loaded. */
static sem_t early_begin, early_end;
static long early_result;

static void *wait_early(void *payload) {
  (void)payload;
  sem_wait(&early_begin);
  early_result = try_open();
  sem_post(&early_end);
  return NULL;
}

static long try_early_thread(void) {
  sem_post(&early_begin);
  sem_wait(&early_end);
  return early_result;
}

static pid_t parent;

static long try_kill(void) {
  return kill(parent, SIGKILL);
}

static long try_kill_group(void) {
  return kill(0, SIGTERM);
}

static long try_ptrace(void) {
  return ptrace(PTRACE_ATTACH, 1, NULL, NULL);
}

static long try_peek(void) {
  char byte;
  struct iovec here = {&byte, 1}, there = {&byte, 1};
  return process_vm_readv(1, &here, 1, &there, 1, 0);
}

static long try_execute(void) {
  return mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) ==
         MAP_FAILED;
}

static long try_share(void) {
  return mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0) == MAP_FAILED;
}

static long try_protect(void) {
  static char page[8192] __attribute__((aligned(4096)));
  return mprotect(page, 4096, PROT_READ | PROT_EXEC);
}

static long try_descriptors(void) {
  while (dup(STDIN_FILENO) >= 0)
    ;
  return 0;
}

static long try_memfd(void) {
  return memfd_create("ill", 0);
}

static long try_limits(void) {
  struct rlimit free = {RLIM_INFINITY, RLIM_INFINITY};
  return setrlimit(RLIMIT_DATA, &free);
}

static long try_setuid(void) {
  return setuid(0);
}

static const struct {
  const char *word;
  long (*run)(void);
} attempts[] = {
    {"try open", try_open},
    {"try openat", try_openat},
    {"try creat", try_creat},
    {"try fopen", try_fopen},
    {"try stat", try_stat},
    {"try opendir", try_opendir},
    {"try unlink", try_unlink},
    {"try socket", try_socket},
    {"try connect", try_connect},
    {"try fork", try_fork},
    {"try thread", try_thread},
    {"try execve", try_execve},
    {"try system", try_system},
    {"try kill parent", try_kill},
    {"try kill group", try_kill_group},
    {"try ptrace", try_ptrace},
    {"try peek", try_peek},
    {"try execute", try_execute},
    {"try share", try_share},
    {"try protect", try_protect},
    {"try descriptors", try_descriptors},
    {"try early thread", try_early_thread},
    {"try memfd", try_memfd},
    {"try limits", try_limits},
    {"try setuid", try_setuid},
};

/** What is not stopped comes back as a failure that says so. */
static vxm_status attempt(const vxm_reader_request *request, vxm_error *error) {
  for (size_t a = 0; a < sizeof attempts / sizeof *attempts; a++)
    if (request->size == strlen(attempts[a].word) &&
        memcmp(request->data, attempts[a].word, request->size) == 0) {
      errno = 0;
      long result = attempts[a].run();
      return vxm_fail(error, VXM_ERROR_RANGE, "%s was let through: %ld, errno %d", attempts[a].word, result,
                      errno);
    }
  return vxm_fail(error, VXM_ERROR_RANGE, "no such attempt");
}

extern char **environ;

/** Tells what there is to find in the process itself: variables, descriptors, folder. */
static vxm_status look_around(vxm_error *error) {
  char found[300] = "";
  size_t used = 0;
  for (char **v = environ; *v && used < sizeof found; v++)
    used += (size_t)snprintf(found + used, sizeof found - used, "%.*s ", (int)strcspn(*v, "="), *v);
  int open_count = 0;
  for (int d = 0; d < 64; d++)
    open_count += write(d, "", 0) >= 0;
  return vxm_fail(error, VXM_ERROR_RANGE, "variables: %sdescriptors: %d", found, open_count);
}

/** Asks for files, as the lines of the mesh name them, and tells how many bytes came. */
static vxm_status ask_for(const vxm_reader_request *request, vxm_context *context, vxm_error *error) {
  char list[2048], told[300] = "", *next = NULL;
  size_t used = 0;
  snprintf(list, sizeof list, "%.*s", (int)request->size - 4, (const char *)request->data + 4);
  for (char *name = strtok_r(list, "\n", &next); name; name = strtok_r(NULL, "\n", &next)) {
    vxm_reader_file file;
    long size = request->fetch(request->payload, context, name, &file) ? (long)file.size : -1;
    if (used < sizeof told)
      used += (size_t)snprintf(told + used, sizeof told - used, " %ld", size);
    if (size >= 0)
      vxm_free(context, file.data);
  }
  return vxm_fail(error, VXM_ERROR_RANGE, "got%s", told);
}

/** For ever asks for the same. */
static vxm_status nag(const vxm_reader_request *request, vxm_context *context, vxm_error *error) {
  vxm_reader_file file;
  long got = 0;
  for (int i = 0; i < 5000; i++)
    if (request->fetch(request->payload, context, "small", &file)) {
      vxm_free(context, file.data);
      got++;
    }
  return vxm_fail(error, VXM_ERROR_RANGE, "got %ld", got);
}

static bool is_asked(const vxm_reader_request *request, const char *word) {
  return request->size >= strlen(word) && memcmp(request->data, word, strlen(word)) == 0;
}

static vxm_status obey(vxm_soup *soup, const vxm_reader_request *request, vxm_error *error) {
  vxm_place place = {request->name, 7, -1, -1};
  if (is_asked(request, "crash"))
    raise(SIGSEGV);
  if (is_asked(request, "abort"))
    abort();
  if (is_asked(request, "quit"))
    exit(9);
  if (is_asked(request, "wait"))
    return wait_for_ever(soup, error);
  if (is_asked(request, "take"))
    return take_all(soup, error);
  if (is_asked(request, "without") || is_asked(request, "choke"))
    do_without(request);
  if (is_asked(request, "choke"))
    abort();
  if (is_asked(request, "odd"))
    ask_oddly();
  if (is_asked(request, "rubbish"))
    send_rubbish();
  if (is_asked(request, "huge") || is_asked(request, "lies"))
    send_lies(is_asked(request, "huge"));
  if (is_asked(request, "print"))
    print_much();
  if (is_asked(request, "fail"))
    return vxm_fail_at(error, VXM_ERROR_FORMAT, place, "as the file wants");
  if (is_asked(request, "hint"))
    return vxm_fail(error, VXM_ERROR_RANGE, "%s %s %g", request->name, request->hint, request->deflection);
  if (is_asked(request, "try"))
    return attempt(request, error);
  if (is_asked(request, "look"))
    return look_around(error);
  if (is_asked(request, "ask "))
    return ask_for(request, soup->context, error);
  if (is_asked(request, "nag"))
    return nag(request, soup->context, error);
  while (is_asked(request, "sleep"))
    usleep(100000);
  while (is_asked(request, "spin"))
    ;
  return make_strip(soup, request->size, error);
}

static void prepare(void) {
  pthread_t early;
  parent = getppid();
  sem_init(&early_begin, 0, 0);
  sem_init(&early_end, 0, 0);
  pthread_create(&early, NULL, wait_early, NULL);
}

static const vxm_reader reader = {prepare, obey, NULL};

VXM_API extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "nothing", "BSD-3-Clause", &reader};
