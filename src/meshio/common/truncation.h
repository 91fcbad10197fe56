/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Texts that end in the middle: a number that touches the end of the file may be half a number. Where a count
 * tells that more should follow it is not believed; where nothing tells, these look for signs.
 */
#ifndef VXM_MESHIO_COMMON_TRUNCATION_H
#define VXM_MESHIO_COMMON_TRUNCATION_H

#include "meshio/common/tokenizer.h"

/** The token that touches the end of the text; the end itself where a blank or a line end comes last. */
const unsigned char *vxm_last_token(const vxm_tokenizer *scan);

/**
 * Whether the last index of the last face may be the beginning of a longer number: there are as many
 * vertices, and no other face has either of its edges there.
 *
 * @param first_number what the file calls the first vertex: 0 or 1
 */
bool vxm_last_index_may_be_truncated(const vxm_soup *soup, uint64_t first_number);

/** Whether the last face may lack corners: the one before has more, and no other has the edge that closes it.
 */
bool vxm_last_face_may_be_short(const vxm_soup *soup);

#endif
