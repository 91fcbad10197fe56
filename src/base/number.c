/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/number.h"
#include "base/c_locale.h"

#include "base/bits.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const double vxm_pow10[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                              1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

const uint64_t vxm_pow10_u64[20] = {UINT64_C(1),
                                    UINT64_C(10),
                                    UINT64_C(100),
                                    UINT64_C(1000),
                                    UINT64_C(10000),
                                    UINT64_C(100000),
                                    UINT64_C(1000000),
                                    UINT64_C(10000000),
                                    UINT64_C(100000000),
                                    UINT64_C(1000000000),
                                    UINT64_C(10000000000),
                                    UINT64_C(100000000000),
                                    UINT64_C(1000000000000),
                                    UINT64_C(10000000000000),
                                    UINT64_C(100000000000000),
                                    UINT64_C(1000000000000000),
                                    UINT64_C(10000000000000000),
                                    UINT64_C(100000000000000000),
                                    UINT64_C(1000000000000000000),
                                    UINT64_C(10000000000000000000)};

/* 5^27 is the last power of five below 2^64. */
enum { POW5_MAX = 27 };
static const uint64_t pow5[POW5_MAX + 1] = {UINT64_C(1),
                                            UINT64_C(5),
                                            UINT64_C(25),
                                            UINT64_C(125),
                                            UINT64_C(625),
                                            UINT64_C(3125),
                                            UINT64_C(15625),
                                            UINT64_C(78125),
                                            UINT64_C(390625),
                                            UINT64_C(1953125),
                                            UINT64_C(9765625),
                                            UINT64_C(48828125),
                                            UINT64_C(244140625),
                                            UINT64_C(1220703125),
                                            UINT64_C(6103515625),
                                            UINT64_C(30517578125),
                                            UINT64_C(152587890625),
                                            UINT64_C(762939453125),
                                            UINT64_C(3814697265625),
                                            UINT64_C(19073486328125),
                                            UINT64_C(95367431640625),
                                            UINT64_C(476837158203125),
                                            UINT64_C(2384185791015625),
                                            UINT64_C(11920928955078125),
                                            UINT64_C(59604644775390625),
                                            UINT64_C(298023223876953125),
                                            UINT64_C(1490116119384765625),
                                            UINT64_C(7450580596923828125)};

/* ---- Text to double ---- */

/** q * 2^exponent where q has at least 62 bits, the lowest of them sticky: one rounding, in the conversion.
 */
static double scale_sticky(uint64_t q, int exponent) {
  uint64_t bits = (uint64_t)(1023 + exponent) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return (double)q * power;
}

bool vxm_decimal(uint64_t w, int e, double *value) {
  if (w == 0) {
    *value = 0.0;
    return true;
  }
  if (w <= UINT64_C(1) << 53 && e >= -22 && e <= 22) {
    /* Both operands are exact, so the one operation is rounded correctly. */
    *value = e < 0 ? (double)w / vxm_pow10[-e] : (double)w * vxm_pow10[e];
    return true;
  }
  if (e < -POW5_MAX || e > POW5_MAX)
    return false;
  int shift = __builtin_clzll(w);
  uint64_t m = w << shift;
  if (e >= 0) {
    vxm_uint128 product = (vxm_uint128)m * pow5[e];
    uint64_t high = (uint64_t)(product >> 64);
    int zeros = high ? __builtin_clzll(high) : 64; /* high is 0 only for e = 0, and then m has its top bit */
    product <<= zeros;
    uint64_t q = (uint64_t)(product >> 64) | ((uint64_t)product != 0);
    *value = scale_sticky(q, e - shift - zeros + 64);
    return true;
  }
  uint64_t divisor = pow5[-e];
  int zeros = __builtin_clzll(divisor);
  divisor <<= zeros;
  /* m * 2^63 / divisor lies between 2^62 and 2^64 since both have their top bit set. */
  vxm_uint128 dividend = (vxm_uint128)m << 63;
  uint64_t q = (uint64_t)(dividend / divisor);
  q |= (uint64_t)(dividend % divisor) != 0;
  *value = scale_sticky(q, e - 63 - shift + zeros);
  return true;
}

static bool is_digit(unsigned char c) {
  return (unsigned)(c - '0') < 10;
}

static unsigned char lower(unsigned char c) {
  return c >= 'A' && c <= 'Z' ? (unsigned char)(c + 32) : c;
}

static bool equals_nocase(const unsigned char *text, size_t length, const char *word) {
  if (strlen(word) != length)
    return false;
  for (size_t i = 0; i < length; i++)
    if (lower(text[i]) != (unsigned char)word[i])
      return false;
  return true;
}

/* The value of any decimal is settled by 768 digits and whether anything follows them. */
enum { DIGITS_KEPT = 780 };

/** Digits and exponent of a number as they are met. */
typedef struct decimal {
  uint64_t w;       /**< the first 19 significant digits */
  int digits;       /**< significant digits in w */
  bool more;        /**< a digit other than 0 follows those of w */
  int64_t exponent; /**< value = w * 10^exponent, but for what is left out */
  bool any;         /**< there was at least one digit */
} decimal;

static const unsigned char *read_digits(const unsigned char *p, const unsigned char *end, bool fraction,
                                        decimal *d) {
  for (; p < end && is_digit(*p); p++) {
    d->any = true;
    unsigned digit = (unsigned)(*p - '0');
    if (d->digits < 19) {
      d->w = d->w * 10 + digit;
      d->digits += d->w != 0;
      d->exponent -= fraction;
    } else {
      d->more |= digit != 0;
      d->exponent += !fraction;
    }
  }
  return p;
}

/** The slow way for what 128 bits cannot settle: all significant digits, through the C library. */
static double parse_long(const unsigned char *text, size_t length, int64_t exponent) {
  char buffer[DIGITS_KEPT + 40];
  size_t used = 0;
  bool sticky = false, point = false;
  int64_t left_out = 0;
  for (size_t i = 0; i < length && (is_digit(text[i]) || text[i] == '.'); i++) {
    if (text[i] == '.') {
      point = true;
      continue;
    }
    if (used == 0 && text[i] == '0') {
      left_out -= point;
      continue;
    }
    if (used < DIGITS_KEPT) {
      buffer[used++] = (char)text[i];
      left_out -= point;
    } else {
      sticky |= text[i] != '0';
      left_out += !point;
    }
  }
  if (sticky) {
    buffer[used++] = '1';
    left_out--;
  }
  exponent += left_out;
  if (exponent > 99999)
    exponent = 99999;
  if (exponent < -99999)
    exponent = -99999;
  snprintf(buffer + used, sizeof buffer - used, "e%d", (int)exponent);
  return strtod_l(buffer, NULL, vxm_c_locale());
}

bool vxm_number_parse(const unsigned char *text, size_t length, double *value) {
  const unsigned char *p = text, *end = text + length;
  bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+'))
    p++;
  const unsigned char *first = p;
  decimal d = {0};
  p = read_digits(p, end, false, &d);
  if (p < end && *p == '.')
    p = read_digits(p + 1, end, true, &d);
  if (!d.any) {
    size_t rest = (size_t)(end - first);
    if (equals_nocase(first, rest, "inf") || equals_nocase(first, rest, "infinity"))
      *value = negative ? -HUGE_VAL : HUGE_VAL;
    else if (equals_nocase(first, rest, "nan"))
      *value = copysign((double)NAN, negative ? -1.0 : 1.0);
    else
      return false;
    return true;
  }
  int64_t exponent = 0;
  if (p < end && (lower(*p) == 'e' || lower(*p) == 'd')) {
    p++;
    bool minus = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
      p++;
    if (p == end || !is_digit(*p))
      return false;
    for (; p < end && is_digit(*p); p++)
      if (exponent < 100000000)
        exponent = exponent * 10 + (*p - '0');
    if (minus)
      exponent = -exponent;
  }
  if (p != end)
    return false;
  double result = 0.0, above;
  int64_t e = d.exponent + exponent;
  /* With digits left out the value lies between w and w + 1; if both round alike, it is settled. */
  bool settled = d.w == 0 || (e >= -400 && e <= 400 && vxm_decimal(d.w, (int)e, &result) &&
                              (!d.more || (vxm_decimal(d.w + 1, (int)e, &above) && above == result)));
  if (!settled)
    result = parse_long(first, (size_t)(end - first), exponent);
  *value = negative ? -result : result;
  return true;
}

/* ---- Double to text ---- */

size_t vxm_number_write_uint(char text[VXM_NUMBER_ROOM], uint64_t value) {
  char digits[20];
  size_t n = 0;
  do
    digits[n++] = (char)('0' + value % 10);
  while (value /= 10);
  for (size_t i = 0; i < n; i++)
    text[i] = digits[n - 1 - i];
  return n;
}

/**
 * value * 10^k rounded to an integer, for 0 <= k <= 27, where the result is below 2^64; exact ties to even.
 */
static uint64_t scaled_integer(double value, int k) {
  int exponent;
  uint64_t m = (uint64_t)ldexp(frexp(value, &exponent), 53);
  vxm_uint128 product = (vxm_uint128)m * pow5[k]; /* below 2^53 * 2^63 */
  int shift = exponent - 53 + k;
  if (shift >= 0)
    return (uint64_t)(product << shift);
  if (shift <= -128)
    return 0;
  vxm_uint128 quotient = product >> -shift, rest = product - (quotient << -shift);
  vxm_uint128 half = (vxm_uint128)1 << (-shift - 1);
  quotient += rest > half || (rest == half && (quotient & 1));
  return (uint64_t)quotient;
}

/** w * 10^-k as plain text, without an exponent. */
static size_t write_plain(char *text, uint64_t w, int k) {
  while (k > 0 && w % 10 == 0) {
    w /= 10;
    k--;
  }
  char digits[VXM_NUMBER_ROOM];
  size_t n = vxm_number_write_uint(digits, w), used = 0;
  if (k <= 0) {
    memcpy(text, digits, n);
    return n;
  }
  size_t fraction = (size_t)k;
  if (n <= fraction) {
    text[used++] = '0';
    text[used++] = '.';
    for (size_t i = n; i < fraction; i++)
      text[used++] = '0';
    memcpy(text + used, digits, n);
    return used + n;
  }
  memcpy(text, digits, n - fraction);
  text[n - fraction] = '.';
  memcpy(text + n - fraction + 1, digits + n - fraction, fraction);
  return n + 1;
}

/** Plain text of a value between 1e-5 and 1e15 in the fewest of `least` to `most` digits that are enough. */
static size_t write_moderate(char *text, double value, int least, int most, bool is_float) {
  int magnitude = (int)floor(log10(value));
  for (int digits = least; digits <= most; digits++) {
    int k = digits - 1 - magnitude;
    if (k < 0)
      k = 0;
    uint64_t w = scaled_integer(value, k);
    double back;
    if (vxm_decimal(w, -k, &back) && (is_float ? (float)back == (float)value : back == value))
      return write_plain(text, w, k);
  }
  return 0;
}

static size_t write_any(char *text, double value, int least, int most, bool is_float) {
  locale_t before = uselocale(vxm_c_locale());
  int length = 0;
  for (int digits = least; digits <= most; digits++) {
    length = snprintf(text, VXM_NUMBER_ROOM, "%.*g", digits, value);
    double back = strtod(text, NULL);
    if (is_float ? (float)back == (float)value : back == value)
      break;
  }
  uselocale(before);
  return length > 0 ? (size_t)length : 0;
}

static size_t write_value(char *text, double value, int least, int most, bool is_float) {
  size_t used = 0;
  if (signbit(value)) {
    text[used++] = '-';
    value = -value;
  }
  if (isnan(value) || isinf(value)) {
    memcpy(text + used, isnan(value) ? "nan" : "inf", 3);
    return used + 3;
  }
  if (value < 1e15 && value == (double)(uint64_t)value)
    return used + vxm_number_write_uint(text + used, (uint64_t)value);
  size_t length = 0;
  if (value >= 1e-5 && value < 1e15)
    length = write_moderate(text + used, value, least, most, is_float);
  if (length == 0) {
    char room[VXM_NUMBER_ROOM];
    length = write_any(room, value, least, most, is_float);
    memcpy(text + used, room, length);
  }
  return used + length;
}

size_t vxm_number_write(char text[VXM_NUMBER_ROOM], double value) {
  return write_value(text, value, DBL_DIG, DBL_DECIMAL_DIG, false);
}

size_t vxm_number_write_float(char text[VXM_NUMBER_ROOM], float value) {
  return write_value(text, (double)value, FLT_DIG, FLT_DECIMAL_DIG, true);
}
