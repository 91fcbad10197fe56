/* SPDX-License-Identifier: BSD-3-Clause */
/** What somebody may have meant who misspelt an option or a command. */
#include "cli/cli.h"

#include <string.h>

enum { WORD_MAX = 32, SHOWN_MAX = 4 };

static int least(int a, int b) {
  return a < b ? a : b;
}

/**
 * How many letters have to be added, left out, changed or exchanged with their neighbours to make one word
 * the other ("optimal string alignment"); WORD_MAX where one is too long to be a name.
 */
static int distance(const char *a, const char *b) {
  int rows = (int)strlen(a), columns = (int)strlen(b);
  int table[WORD_MAX][WORD_MAX];
  if (rows >= WORD_MAX || columns >= WORD_MAX)
    return WORD_MAX;
  for (int i = 0; i <= rows; i++)
    for (int j = 0; j <= columns; j++) {
      if (i == 0 || j == 0) {
        table[i][j] = i + j;
        continue;
      }
      int best = least(table[i - 1][j], table[i][j - 1]) + 1;
      best = least(best, table[i - 1][j - 1] + (a[i - 1] != b[j - 1]));
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        best = least(best, table[i - 2][j - 2] + 1);
      table[i][j] = best;
    }
  return table[rows][columns];
}

/** How far a name is from what was typed: 0 if it begins or ends so; else the number of wrong letters, if
 * these are a third at the most. */
static int badness(const char *typed, const char *name) {
  size_t length = strlen(typed), whole = strlen(name);
  int wrong = distance(typed, name);
  if (length >= 2 && length < whole &&
      (strncmp(name, typed, length) == 0 || (length >= 4 && strcmp(name + whole - length, typed) == 0)))
    return 0;
  return wrong <= (length < 6 ? 1 : (int)length / 3) ? wrong : WORD_MAX;
}

const char *cli_suggestion(char text[CLI_LIST_MAX], const char *typed, const char *before,
                           const char *const *names) {
  int best = WORD_MAX - 1, count = 0, shown = 0;
  text[0] = '\0';
  for (int i = 0; names[i]; i++) {
    int wrong = badness(typed, names[i]);
    if (wrong < best)
      count = 0;
    if (wrong <= best) {
      best = wrong;
      count++;
    }
  }
  size_t used = 0;
  for (int i = 0; names[i] && shown < least(count, SHOWN_MAX); i++)
    if (badness(typed, names[i]) == best) {
      shown++;
      const char *between = shown == 1 ? "; did you mean " : shown == least(count, SHOWN_MAX) ? " or " : ", ";
      used += (size_t)snprintf(text + used, CLI_LIST_MAX - used, "%s%s%s", between, before, names[i]);
    }
  if (shown > 0)
    snprintf(text + used, CLI_LIST_MAX - used, "?");
  return text;
}
