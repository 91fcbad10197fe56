/* SPDX-License-Identifier: BSD-3-Clause */
/** What lies in a zip archive in memory, to look at (PKWARE's application note, 4.3), also with the
 * numbers of 64 bits (zip64) that some programs write for small files, too. */
#ifndef VXM_MODULES_ASSIMP_ZIP_H
#define VXM_MODULES_ASSIMP_ZIP_H

#include "base/context.h"

/** A file within; the name has no end mark. */
typedef struct vxm_zip_member {
  const char *name;
  size_t name_size;
  const unsigned char *data; /**< as it is packed */
  size_t size;
  unsigned method; /**< 0 is not packed, 8 is deflate */
} vxm_zip_member;

/** Where the directory is read next. Start from vxm_zip_open. */
typedef struct vxm_zip {
  const unsigned char *data, *at, *end;
  size_t left; /**< the bytes that may still be unpacked: no more than there are, unless files overlap */
} vxm_zip;

/** False if there is no directory at the end. */
bool vxm_zip_open(vxm_zip *zip, const unsigned char *data, size_t size);
/** False behind the last one, or where the directory is damaged. What is not where an entry says is passed
 * over. */
bool vxm_zip_next(vxm_zip *zip, vxm_zip_member *out);

/** Writes the numbers in the directory of an archive with 32 bits wherever they fit. False if there was
 * nothing to do. */
bool vxm_zip_narrow(unsigned char *data, size_t size);

/** The most bytes that are looked at in one go. */
enum { VXM_ZIP_PIECE = 1 << 16 };

/** Looks at some bytes of a file, at most VXM_ZIP_PIECE, which come in their order; false ends it. */
typedef bool (*vxm_zip_look)(void *payload, const char *bytes, size_t size);

/** Unpacks a file piece by piece. False if it is not unpacked: this build has no zlib, the packing is
 * another, or the files are more than the archive can hold, as where many entries are of the same bytes. */
bool vxm_zip_unpack(vxm_zip *zip, const vxm_zip_member *member, vxm_context *context, vxm_zip_look look,
                    void *payload);

#endif
