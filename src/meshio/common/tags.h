/* SPDX-License-Identifier: BSD-3-Clause */
/** Names of groups and materials on their way to the face tags of a soup. */
#ifndef VXM_MESHIO_COMMON_TAGS_H
#define VXM_MESHIO_COMMON_TAGS_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VXM_TAG_PART_MAX = 255 };

/** A part of a tag; longer names are cut, so that the tags of a file cannot outgrow it without bound. */
typedef struct vxm_tag_part {
  size_t length;
  unsigned char text[VXM_TAG_PART_MAX];
} vxm_tag_part;

/**
 * Tags are made when a face first needs them: "group", "group/material", and "default" where no group was
 * named. A soup none of whose faces had a name keeps no tags.
 */
typedef struct vxm_tagger {
  vxm_soup *soup;
  vxm_tag_part group, material;
  bool named;   /**< a name was given, so that faces need tags from now on */
  bool changed; /**< `current` must be looked up anew */
  uint32_t current;
  uint32_t *slots; /**< open addressing: tag + 1, 0 = free */
  size_t slot_count;
  size_t tag_capacity; /**< elements of soup->face_tags */
} vxm_tagger;

/** Removes all tags of a soup. */
void vxm_tags_drop(vxm_soup *soup);

void vxm_tagger_open(vxm_tagger *tagger, vxm_soup *soup);
void vxm_tagger_close(vxm_tagger *tagger);
/** Takes a new group; blanks around the name are dropped. */
void vxm_tagger_group(vxm_tagger *tagger, const unsigned char *name, size_t length);
/** Takes a new material. */
void vxm_tagger_material(vxm_tagger *tagger, const unsigned char *name, size_t length);
/** Makes room and a tag for the face that is about to be added; call before vxm_face_end. */
vxm_status vxm_tagger_face_slow(vxm_tagger *tagger, vxm_error *error);

static inline vxm_status vxm_tagger_face(vxm_tagger *tagger, vxm_error *error) {
  if (__builtin_expect(!tagger->named, 1))
    return VXM_OK;
  size_t face = tagger->soup->face_count;
  if (tagger->changed || face >= tagger->tag_capacity)
    return vxm_tagger_face_slow(tagger, error);
  tagger->soup->face_tags[face] = tagger->current;
  return VXM_OK;
}

#ifdef __cplusplus
}
#endif
#endif
