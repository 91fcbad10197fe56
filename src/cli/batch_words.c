/* SPDX-License-Identifier: BSD-3-Clause */
/** Words of command lines: taken apart and put together as a POSIX shell does. */
#include "cli/batch.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static bool add_word(batch_words *words, char *word) {
  if (word && words->count + 1 >= words->capacity) {
    int capacity = words->capacity ? 2 * words->capacity : 16;
    char **grown = realloc(words->words, (size_t)capacity * sizeof *grown);
    if (!grown) {
      free(word);
      return false;
    }
    words->words = grown;
    words->capacity = capacity;
  }
  if (!word)
    return false;
  words->words[words->count++] = word;
  words->words[words->count] = NULL;
  return true;
}

bool batch_words_add(batch_words *words, const char *format, ...) {
  va_list arguments;
  char *word = NULL;
  va_start(arguments, format);
  int length = vasprintf(&word, format, arguments);
  va_end(arguments);
  return add_word(words, length < 0 ? NULL : word);
}

/** Takes one word; returns what follows, or NULL where a quote is not closed. */
static const char *take_word(char *word, const char *text) {
  char quote = '\0';
  for (; *text && (quote || !strchr(" \t\r\n", *text)); text++) {
    if (quote ? *text == quote : *text == '"' || *text == '\'')
      quote = quote ? '\0' : *text;
    else if (*text == '\\' && quote != '\'' && text[1])
      *word++ = *++text;
    else
      *word++ = *text;
  }
  *word = '\0';
  return quote ? NULL : text;
}

bool batch_words_split(batch_words *words, const char *text, batch_error *error) {
  const char *whole = text;
  for (;;) {
    text += strspn(text, " \t\r\n");
    if (!*text)
      return true;
    char *word = malloc(strlen(text) + 1);
    text = word ? take_word(word, text) : NULL;
    if (!text) {
      bool is_quote = word != NULL;
      free(word);
      return batch_fail(error,
                        is_quote ? "the options '%s' have a quote that is not closed"
                                 : "out of memory: free some (%s)",
                        whole);
    }
    if (!add_word(words, word))
      return batch_fail(error, "out of memory: free some");
  }
}

static bool is_plain(const char *word) {
  return *word &&
         !word[strspn(word, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./,:@%")];
}

static bool has_controls(const char *word) {
  while ((unsigned char)*word >= ' ')
    word++;
  return *word != '\0';
}

/** A cell of a table has no tabs and ends of lines, so that printf has to make them. */
static void put_printed(FILE *file, const char *word) {
  fputs("\"$(printf -- '", file);
  for (const unsigned char *c = (const unsigned char *)word; *c; c++)
    if (*c < ' ')
      fprintf(file, "\\%03o", *c);
    else
      fputs(*c == '\'' ? "\\047" : *c == '\\' ? "\\\\" : *c == '%' ? "%%" : (char[2]){(char)*c}, file);
  fputs("')\"", file);
}

static void put_quoted(FILE *file, const char *word) {
  fputc('\'', file);
  for (const char *c = word; *c; c++)
    fputs(*c == '\'' ? "'\\''" : (char[2]){*c}, file);
  fputc('\'', file);
}

char *batch_words_text(char *const *words, int count) {
  char *text = NULL;
  size_t size = 0;
  FILE *file = open_memstream(&text, &size);
  for (int w = 0; file && w < count; w++) {
    if (w > 0)
      fputc(' ', file);
    if (is_plain(words[w]))
      fputs(words[w], file);
    else
      (has_controls(words[w]) ? put_printed : put_quoted)(file, words[w]);
  }
  if (file && fclose(file) != 0) {
    free(text);
    return NULL;
  }
  return text;
}

void batch_words_free(batch_words *words) {
  for (int w = 0; w < words->count; w++)
    free(words->words[w]);
  free(words->words);
  *words = (batch_words){0};
}
