/* SPDX-License-Identifier: BSD-3-Clause */
/** Numbers: against strtod on random and hard cases, and written numbers read back. */
#include "meshio_test.h"

#include "base/c_locale.h"
#include "meshio/common/tokenizer.h"

#include <locale.h>

/** The number as the readers see it: through the fast path where `padding` leaves room for it. */
static bool scan_number(const char *text, size_t padding, double *value) {
  size_t length = strlen(text);
  unsigned char *copy = malloc(length + padding + 1);
  assert_non_null(copy);
  memcpy(copy, text, length);
  memset(copy + length, ' ', padding);
  vxm_tokenizer scan = {.begin = copy, .at = copy, .end = copy + length + padding};
  bool good = vxm_tokenizer_double(&scan, value);
  assert_int_equal(scan.at - copy, good ? length : 0);
  free(copy);
  return good;
}

static void expect_number(const char *text, double expected) {
  for (size_t padding = 0; padding <= 64; padding += 64) {
    double value = -1.0;
    if (!scan_number(text, padding, &value))
      fail_msg("\"%s\" is refused", text);
    if (double_to_bits(value) != double_to_bits(expected) && !(isnan(value) && isnan(expected)))
      fail_msg("\"%s\" gives %a instead of %a", text, value, expected);
  }
}

static void expect_as_strtod(const char *text) {
  expect_number(text, strtod_l(text, NULL, vxm_c_locale()));
}

static void test_random_decimals(void **state) {
  (void)state;
  vxm_rng rng = {1};
  char text[80];
  for (int i = 0; i < 400000; i++) {
    double value = random_number(&rng);
    snprintf(text, sizeof text, "%.*g", (int)(1 + vxm_rng_below(&rng, 21)), value);
    expect_as_strtod(text);
    if (fabs(value) < 1e20) {
      snprintf(text, sizeof text, "%.*f", (int)vxm_rng_below(&rng, 26), value);
      expect_as_strtod(text);
    }
  }
}

/** Digits and exponents that no double was printed as: most are hard to round or far off. */
static void test_random_digits(void **state) {
  (void)state;
  vxm_rng rng = {2};
  for (int i = 0; i < 1000000; i++) {
    char text[80];
    size_t used = 0, digits = 1 + (size_t)vxm_rng_below(&rng, 30),
           point = (size_t)vxm_rng_below(&rng, digits + 1);
    if (vxm_rng_below(&rng, 2))
      text[used++] = "+-"[vxm_rng_below(&rng, 2)];
    for (size_t d = 0; d < digits; d++) {
      if (d == point)
        text[used++] = '.';
      text[used++] = (char)('0' + vxm_rng_below(&rng, 10));
    }
    if (vxm_rng_below(&rng, 2))
      snprintf(text + used, sizeof text - used, "%c%d", "eE"[vxm_rng_below(&rng, 2)],
               (int)vxm_rng_below(&rng, 701) - 350);
    else
      text[used] = '\0';
    expect_as_strtod(text);
  }
}

/** Exact midpoints between neighbouring doubles, and just beside them. */
static void test_midpoints(void **state) {
  (void)state;
  vxm_rng rng = {3};
  for (int i = 0; i < 20000; i++) {
    double low = ldexp(1.0 + vxm_rng_unit(&rng), (int)vxm_rng_below(&rng, 60) - 40);
    double high = nextafter(low, HUGE_VAL);
    /* The midpoint needs one bit more; written in long double it is exact. */
    long double middle = ((long double)low + (long double)high) / 2;
    char text[160];
    snprintf(text, sizeof text, "%.110Lf", middle);
    size_t length = strlen(text);
    while (text[length - 1] == '0')
      text[--length] = '\0';
    expect_as_strtod(text);
    text[length] = '1';
    text[length + 1] = '\0';
    expect_number(text, high);
    text[length] = '\0';
    text[length - 1]--;
    expect_number(text, low);
  }
}

static void test_hard_cases(void **state) {
  (void)state;
  static const char *const texts[] = {"0",
                                      "-0",
                                      "+0",
                                      "0.0",
                                      ".0",
                                      "0.",
                                      "-.5",
                                      "5.",
                                      "1e0",
                                      "1E+5",
                                      "1e-5",
                                      "123456789012345678901234567890",
                                      "0.000000000000000000000000000000000000000001",
                                      "9007199254740993",
                                      "9007199254740992.5",
                                      "9007199254740993.00000000000000000000000000000000000001",
                                      "1e22",
                                      "1e23",
                                      "8.5e22",
                                      "123456789012345e22",
                                      "2.2250738585072011e-308",
                                      "2.2250738585072014e-308",
                                      "4.9e-324",
                                      "2.4703282292062327e-324",
                                      "2.4703282292062328e-324",
                                      "1.7976931348623157e308",
                                      "1.7976931348623159e308",
                                      "1e309",
                                      "1e-400",
                                      "1e99999999999999999999",
                                      "1e-99999999999999999999",
                                      "0e99999999999999999999",
                                      "00000000000000000000001",
                                      "0000000000000000000000.1",
                                      "18446744073709551615",
                                      "18446744073709551616",
                                      "9999999999999999999",
                                      "99999999999999999999",
                                      "0.1",
                                      "0.30000000000000004",
                                      "3.14159265358979323846264338327950288",
                                      "1.00000000000000011102230246251565404236316680908203124",
                                      "1.00000000000000011102230246251565404236316680908203125",
                                      "1.00000000000000011102230246251565404236316680908203126",
                                      "12345678",
                                      "12345678.12345678",
                                      "1234567.1234567",
                                      "-12345678.123456789",
                                      "0.0000001234567890123456789"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    expect_as_strtod(texts[i]);
  expect_number("1d3", 1000.0);
  expect_number("1.5D-1", 0.15);
  expect_number("nan", (double)NAN);
  expect_number("-NaN", (double)NAN);
  expect_number("inf", HUGE_VAL);
  expect_number("-Infinity", -HUGE_VAL);
  expect_number("+INF", HUGE_VAL);
}

static void test_no_numbers(void **state) {
  (void)state;
  static const char *const texts[] = {"",     "-",         "+",          ".",    "-.",     "e5",
                                      "1e",   "1e+",       "1.2.3",      "1,5",  "1.#IND", "0x10",
                                      "--1",  "+-1",       "1-",         "na",   "nanx",   "infinit",
                                      "1e5x", "12345678a", "1.2345678b", "\x10", "1f"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    double value;
    assert_false(scan_number(texts[i], 0, &value));
    assert_false(scan_number(texts[i], 64, &value));
  }
}

/** A million digits are read once, not once for each. */
static void test_very_long_numbers(void **state) {
  (void)state;
  size_t length = 1000000;
  char *text = malloc(length + 8);
  assert_non_null(text);
  memset(text, '0', length);
  memcpy(text, "0.", 2);
  strcpy(text + length, "123");
  expect_number(text, 0.0);
  memset(text, '1', length);
  strcpy(text + length, ".5");
  expect_number(text, HUGE_VAL);
  text[1] = '.';
  text[length] = '\0';
  expect_number(text, 1.1111111111111112);
  /* Halfway between two doubles but for the last of a million digits. */
  memset(text, '0', length);
  memcpy(text, "9007199254740993.", 17);
  expect_number(text, 9007199254740992.0);
  text[length - 1] = '1';
  expect_number(text, 9007199254740994.0);
  free(text);
}

static void test_whole_numbers(void **state) {
  (void)state;
  vxm_rng rng = {4};
  char text[64];
  for (int i = 0; i < 200000; i++) {
    uint64_t expected = vxm_rng_next(&rng) >> (1 + vxm_rng_below(&rng, 63)), value;
    int length = snprintf(text, sizeof text, "%llu ", (unsigned long long)expected) - 1;
    for (int padding = 0; padding < 2; padding++) {
      memset(text + length + 1, ' ', 20);
      vxm_tokenizer scan = {.at = (unsigned char *)text,
                            .end = (unsigned char *)text + length + 20 * padding};
      assert_true(vxm_tokenizer_uint(&scan, &value));
      assert_true(value == expected);
      assert_int_equal(scan.at - (unsigned char *)text, length);
    }
  }
  static const char *const no[] = {"-1", "1.0", "x", "1x", "12345678x", ""};
  for (size_t i = 0; i < sizeof no / sizeof *no; i++) {
    uint64_t value;
    vxm_tokenizer scan = {.at = (const unsigned char *)no[i],
                          .end = (const unsigned char *)no[i] + strlen(no[i])};
    assert_false(vxm_tokenizer_uint(&scan, &value));
    assert_ptr_equal(scan.at, no[i]);
  }
  uint64_t huge;
  const char *digits = "99999999999999999999999999";
  vxm_tokenizer scan = {.at = (const unsigned char *)digits,
                        .end = (const unsigned char *)digits + strlen(digits)};
  assert_true(vxm_tokenizer_uint(&scan, &huge));
  assert_true(huge == UINT64_C(1) << 63);
}

static void expect_written(double value) {
  char text[VXM_NUMBER_ROOM + 1], shortest[64];
  size_t length = vxm_number_write(text, value);
  assert_true(length < VXM_NUMBER_ROOM);
  text[length] = '\0';
  double back = strtod_l(text, NULL, vxm_c_locale());
  if (double_to_bits(back) != double_to_bits(value))
    fail_msg("%a is written as \"%s\"", value, text);
  /* No shorter in digits than the C library needs. */
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(shortest, sizeof shortest, "%.*g", digits, value);
    if (strtod_l(shortest, NULL, vxm_c_locale()) == value)
      break;
  }
  size_t ours = 0, theirs = 0;
  for (const char *p = text; *p && *p != 'e'; p++)
    ours += *p >= '0' && *p <= '9' && (ours > 0 || *p != '0');
  for (const char *p = shortest; *p && *p != 'e'; p++)
    theirs += *p >= '0' && *p <= '9' && (theirs > 0 || *p != '0');
  if (value != 0.0 && fabs(value) < 1e15 && ours > theirs)
    fail_msg("%a is written as \"%s\", not \"%s\"", value, text, shortest);
}

static void test_written_numbers(void **state) {
  (void)state;
  vxm_rng rng = {5};
  for (int i = 0; i < 200000; i++)
    expect_written(random_number(&rng));
  static const double values[] = {0.0,
                                  -0.0,
                                  1.0,
                                  -1.0,
                                  0.1,
                                  0.3,
                                  1e15,
                                  1e16,
                                  1e22,
                                  1e23,
                                  1e300,
                                  5e-324,
                                  1e-5,
                                  9.9999999999999e-6,
                                  0.001,
                                  123456789012345.0,
                                  999999999999999.9,
                                  0x1p53,
                                  0x1.fffffffffffffp1023,
                                  1.0 / 3.0,
                                  2.0 / 3.0};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    expect_written(values[i]);
  char text[VXM_NUMBER_ROOM];
  assert_int_equal(vxm_number_write(text, 0.1), 3);
  assert_memory_equal(text, "0.1", 3);
  assert_int_equal(vxm_number_write(text, -25.0), 3);
  assert_memory_equal(text, "-25", 3);
  assert_int_equal(vxm_number_write(text, (double)NAN), 3);
  assert_memory_equal(text, "nan", 3);
  assert_int_equal(vxm_number_write(text, -HUGE_VAL), 4);
  assert_memory_equal(text, "-inf", 4);
}

static void test_written_floats(void **state) {
  (void)state;
  vxm_rng rng = {6};
  for (int i = 0; i < 200000; i++) {
    float value = (float)random_number(&rng);
    if (!isfinite(value))
      continue;
    char text[VXM_NUMBER_ROOM + 1];
    size_t length = vxm_number_write_float(text, value);
    text[length] = '\0';
    float back = strtof_l(text, NULL, vxm_c_locale());
    if (memcmp(&back, &value, sizeof value) != 0)
      fail_msg("%a is written as \"%s\"", (double)value, text);
    assert_true((float)strtod_l(text, NULL, vxm_c_locale()) == value);
  }
}

/** Where the decimal point is a comma nothing changes. */
static void test_locale(void **state) {
  (void)state;
  static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8"};
  const char *set = NULL;
  for (size_t i = 0; i < sizeof names / sizeof *names && !set; i++)
    set = setlocale(LC_ALL, names[i]);
  if (!set)
    skip();
  expect_number("0.5", 0.5);
  expect_number("0.1000000000000000055511151231257827021181583404541015625000001", 0.1);
  char text[VXM_NUMBER_ROOM];
  assert_int_equal(vxm_number_write(text, 0x1p-70), strlen("8.470329472543003e-22"));
  assert_memory_equal(text, "8.470329472543003e-22", strlen("8.470329472543003e-22"));
  setlocale(LC_ALL, "C");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random_decimals), cmocka_unit_test(test_random_digits),
      cmocka_unit_test(test_midpoints),       cmocka_unit_test(test_hard_cases),
      cmocka_unit_test(test_no_numbers),      cmocka_unit_test(test_very_long_numbers),
      cmocka_unit_test(test_whole_numbers),   cmocka_unit_test(test_written_numbers),
      cmocka_unit_test(test_written_floats),  cmocka_unit_test(test_locale)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
