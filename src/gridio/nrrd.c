/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/nrrd.h"
#include "gridio/bytes.h"

#include <inttypes.h>

void vxm_nrrd_header_write(vxm_output *output, const char *type, size_t size, const vxm_space *space) {
  const int64_t *dims = space->dims;
  const double *step = space->voxel_size, *corner = space->origin;
  vxm_output_printf(output, "NRRD0004\n# a number per voxel, at its centre\ntype: %s\ndimension: 3\n", type);
  vxm_output_printf(output, "space dimension: 3\nsizes: %" PRId64 " %" PRId64 " %" PRId64 "\n", dims[0],
                    dims[1], dims[2]);
  vxm_output_printf(output, "space directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\n", step[0], step[1],
                    step[2]);
  vxm_output_printf(output, "kinds: domain domain domain\ncenterings: cell cell cell\n");
  if (size > 1)
    vxm_output_printf(output, "endian: %s\n", vxm_le64(1) == 1 ? "little" : "big");
  /* The origin of an NRRD file is the centre of its first sample. */
  vxm_output_printf(output, "encoding: raw\nspace origin: (%.17g,%.17g,%.17g)\n\n", corner[0] + step[0] / 2,
                    corner[1] + step[1] / 2, corner[2] + step[2] / 2);
}
