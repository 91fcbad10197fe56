/* SPDX-License-Identifier: BSD-3-Clause */
/** Where new files come to lie, with which rights, and several of them at once. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/output.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NOBODY = 65534 };

static char start[1024], folder[64];
static vxm_context *context;

static int enter(void **state) {
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/voxmend-new-XXXXXX");
  umask(022);
  return !getcwd(start, sizeof start) || !mkdtemp(folder) || chdir(folder) != 0 ||
         vxm_context_create(&context, NULL, NULL) != VXM_OK;
}

static int leave(void **state) {
  (void)state;
  char command[128];
  vxm_context_destroy(context);
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return chdir(start) != 0 || system(command) != 0;
}

static vxm_status put(const char *path, const char *text) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_file_write(context, path, text, strlen(text), &error);
  assert_true(status == VXM_OK || (error.text[0] && !strchr(error.text, '\n')));
  return status;
}

static void assert_holds(const char *path, const char *text) {
  char data[64] = "";
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  size_t size = fread(data, 1, sizeof data - 1, file);
  fclose(file);
  data[size] = '\0';
  assert_string_equal(data, text);
}

static mode_t mode_of(const char *path) {
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  return info.st_mode & 07777;
}

static int files_here(void) {
  DIR *list = opendir(".");
  assert_non_null(list);
  int count = 0;
  for (struct dirent *entry; (entry = readdir(list));)
    count += entry->d_name[0] != '.';
  closedir(list);
  return count;
}

/* ---- Rights ---- */

static void old_rights_without_special_bits(void **state) {
  (void)state;
  static const struct {
    mode_t old, expected;
  } cases[] = {{0600, 0600},  {0644, 0644},  {0751, 0751}, {04755, 0755},
               {02775, 0775}, {01666, 0666}, {07777, 0777}};
  assert_int_equal(put("new", "x"), VXM_OK);
  assert_int_equal(mode_of("new"), 0644);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    assert_int_equal(put("a", "old"), VXM_OK);
    assert_int_equal(chmod("a", cases[i].old), 0);
    assert_int_equal(put("a", "new"), VXM_OK);
    assert_int_equal(mode_of("a"), cases[i].expected);
  }
  umask(077);
  assert_int_equal(put("closed", "x"), VXM_OK);
  umask(022);
  assert_int_equal(mode_of("closed"), 0600);
}

/** Nobody but its user reads what is not complete. */
static void narrow_until_complete(void **state) {
  (void)state;
  vxm_output *output;
  assert_int_equal(put("a", "old"), VXM_OK);
  assert_int_equal(chmod("a", 0666), 0);
  assert_int_equal(vxm_output_open(&output, context, "a", NULL), VXM_OK);
  bool found = false;
  for (int descriptor = 3; descriptor < 64; descriptor++) {
    struct stat info;
    if (fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode) && info.st_uid == geteuid() &&
        info.st_size == 0 && (fcntl(descriptor, F_GETFL) & O_ACCMODE) == O_RDWR) {
      assert_int_equal(info.st_mode & 07777, 0600);
      found = true;
    }
  }
  assert_true(found);
  vxm_output_abort(output);
}

static void strangers_rights_are_not_taken_over(void **state) {
  (void)state;
  if (geteuid() != 0)
    skip();
  assert_int_equal(put("a", "old"), VXM_OK);
  assert_int_equal(chown("a", NOBODY, NOBODY), 0);
  assert_int_equal(chmod("a", 06777), 0);
  assert_int_equal(put("a", "new"), VXM_OK);
  assert_int_equal(mode_of("a"), 0644);
  struct stat info;
  assert_int_equal(stat("a", &info), 0);
  assert_int_equal(info.st_uid, 0);
  assert_int_equal(info.st_gid, getegid());
}

static void group_is_kept(void **state) {
  (void)state;
  if (geteuid() != 0)
    skip();
  struct stat info;
  assert_int_equal(put("a", "old"), VXM_OK);
  assert_int_equal(chown("a", 0, NOBODY), 0);
  assert_int_equal(chmod("a", 0640), 0);
  assert_int_equal(put("a", "new"), VXM_OK);
  assert_int_equal(stat("a", &info), 0);
  assert_int_equal(info.st_gid, NOBODY);
  assert_int_equal(info.st_mode & 07777, 0640);
}

/* ---- Links ---- */

static void links_stay_links(void **state) {
  (void)state;
  struct stat info;
  assert_int_equal(mkdir("deep", 0755), 0);
  assert_int_equal(put("deep/file", "old"), VXM_OK);
  assert_int_equal(symlink("file", "deep/link"), 0);
  assert_int_equal(symlink("deep/link", "first"), 0);
  assert_int_equal(symlink("deep/later", "dangling"), 0);
  assert_int_equal(symlink("loop", "loop"), 0);
  assert_int_equal(put("first", "new"), VXM_OK);
  assert_holds("deep/file", "new");
  assert_int_equal(put("dangling", "later"), VXM_OK);
  assert_holds("deep/later", "later");
  assert_true(lstat("first", &info) == 0 && S_ISLNK(info.st_mode));
  assert_true(lstat("dangling", &info) == 0 && S_ISLNK(info.st_mode));
  assert_int_equal(put("loop", "x"), VXM_ERROR_IO);
  assert_int_equal(put("deep", "x"), VXM_ERROR_IO);
  assert_int_equal(put("deep/", "x"), VXM_ERROR_IO);
  assert_int_equal(put("none/", "x"), VXM_ERROR_IO);
  assert_int_equal(put("none/x", "x"), VXM_ERROR_IO);
  assert_int_equal(put("deep/file/x", "x"), VXM_ERROR_IO);
  assert_int_equal(put("", "x"), VXM_ERROR_IO);
  assert_int_equal(put("deep/../deep/.//file", "dots"), VXM_OK);
  assert_holds("deep/file", "dots");
}

/** The kernel's own rule (fs.protected_symlinks) may be off. */
static void strangers_links_are_not_followed(void **state) {
  (void)state;
  if (geteuid() != 0)
    skip();
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(mkdir("shared", 0777), 0);
  assert_int_equal(chmod("shared", 01777), 0);
  assert_int_equal(put("target", "old"), VXM_OK);
  static const char *const links[][2] = {
      {"../target", "shared/a"}, {"/dev/null", "shared/b"}, {"..", "shared/c"}};
  for (int i = 0; i < 3; i++) {
    assert_int_equal(symlink(links[i][0], links[i][1]), 0);
    assert_int_equal(lchown(links[i][1], NOBODY, NOBODY), 0);
  }
  assert_int_equal(put("shared/a", "x"), VXM_ERROR_IO);
  assert_int_equal(put("shared/b", "x"), VXM_ERROR_IO);
  assert_int_equal(vxm_file_write(context, "shared/c/target", "x", 1, &error), VXM_ERROR_IO);
  assert_non_null(strstr(error.text, "another user's link"));
  assert_holds("target", "old");
  assert_int_equal(lchown("shared/a", 0, 0), 0); /* one's own */
  assert_int_equal(put("shared/a", "own"), VXM_OK);
  assert_holds("target", "own");
  assert_int_equal(chmod("shared", 0777), 0); /* not such a folder */
  assert_int_equal(put("shared/c/target", "plain"), VXM_OK);
  assert_holds("target", "plain");
}

/* ---- Temporary names ---- */

/** The name that a file replacing "a" has for an instant: seen when it is taken. */
static void abandoned_names_are_removed(void **state) {
  (void)state;
  const char *const first = "voxmend-e40c292c-0.tmp"; /* FNV-1a of "a" */
  assert_int_equal(put("a", "old"), VXM_OK);
  int descriptor = open(first, O_RDWR | O_CREAT | O_EXCL, 0600);
  assert_true(descriptor >= 0);
  assert_int_equal(flock(descriptor, LOCK_EX), 0);
  assert_int_equal(put("a", "busy"), VXM_OK); /* somebody writes there: it is left alone */
  assert_int_equal(access(first, F_OK), 0);
  assert_int_equal(files_here(), 2);
  close(descriptor);
  assert_int_equal(put("a", "new"), VXM_OK);
  assert_holds("a", "new");
  assert_int_equal(files_here(), 1);
}

/* ---- Several files ---- */

static void all_or_none(void **state) {
  (void)state;
  assert_int_equal(put("a", "old"), VXM_OK);
  assert_int_equal(mkdir("there", 0755), 0);
  assert_int_equal(vxm_context_hold_files(context, NULL), VXM_OK);
  assert_int_equal(put("a", "new"), VXM_OK);
  assert_int_equal(put("b", "new"), VXM_OK);
  assert_int_equal(put("there/c", "new"), VXM_OK);
  assert_int_equal(put("there/../b", "twice"), VXM_ERROR_ARGUMENT);
  assert_holds("a", "old");
  assert_int_equal(access("b", F_OK), -1);
  assert_int_equal(rmdir("there"), 0);
  assert_int_equal(vxm_context_publish_files(context, NULL), VXM_ERROR_IO);
  assert_holds("a", "old");
  assert_int_equal(files_here(), 1);

  assert_int_equal(vxm_context_hold_files(context, NULL), VXM_OK);
  assert_int_equal(put("a", "new"), VXM_OK);
  assert_int_equal(put("b", "new"), VXM_OK);
  assert_int_equal(vxm_context_publish_files(context, NULL), VXM_OK);
  assert_holds("a", "new");
  assert_holds("b", "new");
  assert_int_equal(files_here(), 2);

  assert_int_equal(vxm_context_hold_files(context, NULL), VXM_OK);
  assert_int_equal(put("a", "dropped"), VXM_OK);
  vxm_context_drop_files(context);
  assert_holds("a", "new");
  assert_int_equal(put("a", "at once"), VXM_OK); /* nothing is held any more */
  assert_holds("a", "at once");
  assert_int_equal(vxm_context_hold_files(NULL, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_context_publish_files(NULL, NULL), VXM_OK);
  vxm_context_drop_files(NULL);
}

/* ---- Room ---- */

static void room_is_asked_for(void **state) {
  (void)state;
  vxm_error error = VXM_ERROR_INIT;
  vxm_output *output;
  assert_int_equal(vxm_output_open(&output, context, "a", NULL), VXM_OK);
  assert_int_equal(vxm_output_expect(output, UINT64_C(4) << 20, NULL), VXM_OK);
  vxm_output_write(output, "x", 1);
  assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
  assert_holds("a", "x");
  assert_int_equal(vxm_output_open(&output, context, "a", NULL), VXM_OK);
  assert_int_equal(vxm_output_expect(output, UINT64_C(3) << 59, &error), VXM_ERROR_IO);
  assert_non_null(strstr(error.text, "1572864.0 TiB"));
  vxm_output_abort(output);
  assert_holds("a", "x");
  assert_int_equal(vxm_output_open(&output, context, "/dev/null", NULL), VXM_OK);
  assert_int_equal(vxm_output_expect(output, UINT64_C(3) << 59, NULL), VXM_OK);
  vxm_output_abort(output);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, enter, leave)
  const struct CMUnitTest tests[] = {
      TEST(old_rights_without_special_bits),
      TEST(narrow_until_complete),
      TEST(strangers_rights_are_not_taken_over),
      TEST(group_is_kept),
      TEST(links_stay_links),
      TEST(strangers_links_are_not_followed),
      TEST(abandoned_names_are_removed),
      TEST(all_or_none),
      TEST(room_is_asked_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
