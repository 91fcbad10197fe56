/* SPDX-License-Identifier: BSD-3-Clause */
/** How the appearance of a mesh goes over, behind its soup, where it is wanted. */
#ifndef VXM_SANDBOX_WIRE_APPEARANCE_H
#define VXM_SANDBOX_WIRE_APPEARANCE_H

#include "base/process.h"
#include "mesh/soup.h"

/** The reading side; false if our process has gone. */
bool vxm_wire_send_appearance(int channel, const vxm_appearance *appearance);

/** Fills the empty appearance of a soup that has arrived. Nothing of it is trusted. @return as
 * vxm_wire_receive */
vxm_status vxm_wire_receive_appearance(vxm_soup *soup, vxm_process *sender, vxm_error *error);

#endif
