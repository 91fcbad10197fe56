/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/common/tags.h"

#include "base/hash.h"

#include <string.h>

static const char unnamed[] = "default";

void vxm_tags_drop(vxm_soup *soup) {
  for (size_t t = 0; t < soup->tag_count; t++)
    vxm_free(soup->context, soup->tags[t]);
  vxm_free(soup->context, soup->face_tags);
  soup->face_tags = NULL;
  soup->tag_count = 0;
}

void vxm_tagger_open(vxm_tagger *tagger, vxm_soup *soup) {
  memset(tagger, 0, sizeof *tagger);
  tagger->soup = soup;
}

void vxm_tagger_close(vxm_tagger *tagger) {
  vxm_free(tagger->soup->context, tagger->slots);
  tagger->slots = NULL;
}

static bool is_blank(unsigned char c) {
  return c <= ' ';
}

/** Copies a name without the blanks around it, cut between characters of UTF-8. */
static void take(vxm_tag_part *part, const unsigned char *name, size_t length) {
  while (length > 0 && is_blank(name[0])) {
    name++;
    length--;
  }
  while (length > 0 && is_blank(name[length - 1]))
    length--;
  if (length > VXM_TAG_PART_MAX) {
    length = VXM_TAG_PART_MAX;
    while (length > 0 && (name[length] & 0xc0) == 0x80)
      length--;
  }
  if (length > 0)
    memcpy(part->text, name, length);
  part->length = length;
}

void vxm_tagger_group(vxm_tagger *tagger, const unsigned char *name, size_t length) {
  take(&tagger->group, name, length);
  tagger->named = tagger->changed = true;
}

void vxm_tagger_material(vxm_tagger *tagger, const unsigned char *name, size_t length) {
  take(&tagger->material, name, length);
  tagger->named = tagger->changed = true;
}

/** Bytes of the UTF-8 character at `text`, 0 if it is none (Unicode standard, table 3-7). */
static size_t character(const unsigned char *text, size_t length) {
  unsigned char c = text[0];
  size_t n = c < 0x80 ? 1 : c < 0xc2 ? 0 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : c < 0xf5 ? 4 : 0;
  if (n == 0 || n > length)
    return 0;
  for (size_t i = 1; i < n; i++)
    if ((text[i] & 0xc0) != 0x80)
      return 0;
  if ((c == 0xe0 && text[1] < 0xa0) || (c == 0xed && text[1] > 0x9f) || (c == 0xf0 && text[1] < 0x90) ||
      (c == 0xf4 && text[1] > 0x8f))
    return 0;
  return n;
}

/** Puts '?' for what is not UTF-8, and for control characters. */
static void make_utf8(unsigned char *text, size_t length) {
  for (size_t i = 0; i < length;) {
    size_t n = character(text + i, length - i);
    if (n == 0 || text[i] < ' ' || text[i] == 0x7f)
      text[i] = '?';
    i += n ? n : 1;
  }
}

/** Joins the parts into one name. */
static size_t join(const vxm_tagger *tagger, char name[2 * VXM_TAG_PART_MAX + 2]) {
  size_t length = tagger->group.length;
  if (length > 0)
    memcpy(name, tagger->group.text, length);
  else {
    length = sizeof unnamed - 1;
    memcpy(name, unnamed, length);
  }
  if (tagger->material.length > 0) {
    name[length++] = '/';
    memcpy(name + length, tagger->material.text, tagger->material.length);
    length += tagger->material.length;
  }
  make_utf8((unsigned char *)name, length);
  name[length] = '\0';
  return length;
}

static uint64_t hash_name(const char *name, size_t length) {
  uint64_t hash = 0;
  for (; length >= 8; name += 8, length -= 8) {
    uint64_t word;
    memcpy(&word, name, sizeof word);
    hash = vxm_hash_word(hash, word);
  }
  uint64_t word = length;
  for (size_t i = 0; i < length; i++)
    word = word << 8 | (unsigned char)name[i];
  return vxm_hash_word(hash, word);
}

static vxm_status grow_slots(vxm_tagger *tagger, vxm_error *error) {
  vxm_soup *soup = tagger->soup;
  vxm_status status = VXM_OK;
  size_t count = tagger->slot_count ? tagger->slot_count * 2 : 64;
  uint32_t *slots = vxm_try_calloc(soup->context, count, sizeof *slots, &status, error);
  if (!slots)
    return status;
  for (size_t t = 0; t < soup->tag_count; t++) {
    size_t slot = (size_t)hash_name(soup->tags[t], strlen(soup->tags[t])) & (count - 1);
    while (slots[slot])
      slot = (slot + 1) & (count - 1);
    slots[slot] = (uint32_t)t + 1;
  }
  vxm_free(soup->context, tagger->slots);
  tagger->slots = slots;
  tagger->slot_count = count;
  return VXM_OK;
}

/** The number of a tag of this name, which is made if it is new. */
static vxm_status intern(vxm_tagger *tagger, const char *name, size_t length, uint32_t *tag,
                         vxm_error *error) {
  vxm_soup *soup = tagger->soup;
  if (2 * soup->tag_count >= tagger->slot_count) {
    vxm_status status = grow_slots(tagger, error);
    if (status != VXM_OK)
      return status;
  }
  size_t slot = (size_t)hash_name(name, length) & (tagger->slot_count - 1);
  for (; tagger->slots[slot]; slot = (slot + 1) & (tagger->slot_count - 1)) {
    *tag = tagger->slots[slot] - 1;
    if (strcmp(soup->tags[*tag], name) == 0)
      return VXM_OK;
  }
  vxm_status status = vxm_soup_add_tag(soup, name, length, tag, error);
  if (status == VXM_OK)
    tagger->slots[slot] = *tag + 1;
  return status;
}

vxm_status vxm_tagger_face_slow(vxm_tagger *tagger, vxm_error *error) {
  vxm_soup *soup = tagger->soup;
  size_t face = soup->face_count;
  vxm_status status = vxm_grow(soup->context, (void **)&soup->face_tags, &tagger->tag_capacity, face + 1,
                               sizeof *soup->face_tags, error);
  if (status == VXM_OK && soup->tag_count == 0 && face > 0) {
    /* Faces were read before the first name: they are the first tag. */
    uint32_t first;
    status = intern(tagger, unnamed, sizeof unnamed - 1, &first, error);
    memset(soup->face_tags, 0, face * sizeof *soup->face_tags);
  }
  char name[2 * VXM_TAG_PART_MAX + 2];
  if (status == VXM_OK && tagger->changed)
    status = intern(tagger, name, join(tagger, name), &tagger->current, error);
  if (status != VXM_OK)
    return status;
  tagger->changed = false;
  soup->face_tags[face] = tagger->current;
  return VXM_OK;
}
